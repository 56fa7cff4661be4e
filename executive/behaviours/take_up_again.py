"""Give stones that were set aside another chance."""

from executive.events.stone import StonesTakenUpAgain
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import Stone, StoneState


class TakeUpAgain(Condition):
    """Make stones movable again that were set aside before another was placed; fail if none was.

    What was in their way may be gone. Where nothing has moved since, another attempt would end as
    the last one did, and so it would for a stone that is too heavy: those are left.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        objects = self.context.use(ObjectDatabase)
        stones = objects.stones()
        last_placed_s = max(
            (self._since_s(s) for s in stones if s.state is StoneState.PLACED),
            default=float("-inf"),
        )
        left = tuple(
            s.id
            for s in stones
            if s.state is StoneState.SET_ASIDE
            and self._since_s(s) < last_placed_s
            and not self.context.is_given_up(s.id)
        )
        if not left:
            return failed("no stone was set aside for a reason that may be gone")
        for stone_id in left:
            objects.set_state(stone_id, StoneState.ON_GROUND, self.context.now_s())
        self.context.record(StonesTakenUpAgain(left))
        return succeeded(reason=f"stones {list(left)} are attempted again")

    def _since_s(self, stone: Stone) -> float:
        """Return since when a stone has its state [s]."""
        history = self.context.use(ObjectDatabase).history(stone.id)
        before = [i for i, event in enumerate(history) if event.state is not stone.state]
        return float(history[before[-1] + 1 if before else 0].stamp_s)
