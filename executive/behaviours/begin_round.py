"""Begin the next round of relocations."""

from executive.events.site import RoundBegun
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded
from executive.messages.stone import StoneState


class BeginRound(Condition):
    """Make all placed stones movable again; the map and the identities are kept.

    Source: Mascaro et al. 2020, Sec. 6.1, second experiment.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        objects = self.context.use(ObjectDatabase)
        placed = tuple(s.id for s in objects.stones() if s.state is StoneState.PLACED)
        for stone_id in placed:
            objects.set_state(stone_id, StoneState.ON_GROUND, self.context.now_s())
        self.context.record(RoundBegun(placed))
        return succeeded(reason=f"{len(placed)} stones to move")
