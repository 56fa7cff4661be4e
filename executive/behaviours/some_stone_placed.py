"""Ask whether the work was of any use."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


class SomeStonePlaced(Condition):
    """Succeed if at least one stone stands in a slot."""

    needs = ("objects",)

    def check(self, **inputs: Any) -> Outcome:
        stones = self.context.plugin("objects").stones()
        placed = [stone.id for stone in stones if stone.state is StoneState.PLACED]
        if not placed:
            return failed(f"none of {len(stones)} stones could be placed: all were set aside")
        return succeeded(f"{len(placed)} of {len(stones)} stones placed")
