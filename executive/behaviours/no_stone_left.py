"""Ask whether there is still work."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


class NoStoneLeft(Condition):
    """Succeed when no known stone lies on the ground any more: each is placed or set aside."""

    needs = ("objects",)

    def check(self, **inputs: Any) -> Outcome:
        left = [
            s.id for s in self.context.plugin("objects").stones() if s.state is StoneState.ON_GROUND
        ]
        return failed(f"stones {left} are left") if left else succeeded()
