"""Begin the next round of relocations."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, succeeded
from executive.messages.stone import StoneState


class BeginRound(Condition):
    """Make all placed stones movable again; the map and the identities stay (Mascaro 2020, Sec.
    6.1, experiment 2).
    """

    needs = ("objects",)

    def check(self, **inputs: Any) -> Outcome:
        objects = self.context.plugin("objects")
        placed = [stone.id for stone in objects.stones() if stone.state is StoneState.PLACED]
        for stone_id in placed:
            objects.set_state(stone_id, StoneState.ON_GROUND, self.context.now_s())
        self.context.note("round", stones=placed)
        return succeeded(f"{len(placed)} stones to move")
