"""Ask whether something is in the jaws."""

from typing import Any

from pydantic import Field

from executive.config import Radians, Settings
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.verdict import Trouble


class IsHoldingSettings(Settings):
    empty_below: Radians = Field(
        0.08, ge=0, le=1, description="Jaws that stand below this hold nothing [rad]."
    )


class IsHolding(Condition):
    """Succeed while the jaws stand apart and no monitor has seen the stone fall."""

    Settings = IsHoldingSettings
    needs = ("monitoring",)

    def check(self, **inputs: Any) -> Outcome:
        angle = self.context.joints().of(self.context.machine().jaw.name)[0]
        if angle < self.settings.empty_below:
            return failed(f"the jaws are closed to {angle:.2f} rad")
        if any(v.trouble is not Trouble.SLIP for v in self.context.verdicts()):
            return failed("the stone was dropped")
        return succeeded()
