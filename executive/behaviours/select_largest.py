"""Choose the next stone."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.port import Port
from executive.messages.stone import StoneState


class SelectLargest(Condition):
    """Choose the stone of most points that lies on the ground (Mascaro 2020, Sec. 5.1); fails when
    none is left.
    """

    needs = ("objects",)
    outputs = {"stone": Port(int, "id of the stone")}

    def check(self, **inputs: Any) -> Outcome:
        stones = [
            s for s in self.context.plugin("objects").stones() if s.state is StoneState.ON_GROUND
        ]
        if not stones:
            return failed("no stone is left on the ground")
        largest = max(stones, key=lambda stone: (len(stone.points_map), -stone.id))
        return succeeded(f"stone {largest.id}", stone=largest.id)
