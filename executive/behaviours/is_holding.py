"""Ask whether something is in the jaws."""

from pydantic import Field

from executive.config import Radians, Settings
from executive.interfaces.monitoring import Monitor
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.verdict import Trouble


class IsHoldingSettings(Settings):
    empty_below: Radians = Field(
        0.08, ge=0, le=1, description="Jaws that are closed further than this hold nothing [rad]."
    )


class IsHolding(Condition[IsHoldingSettings]):
    """Succeed while the jaws are held apart and no monitor has reported a fall."""

    needs = (Monitor,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        angle_rad = self.context.joints().of(self.context.machine().jaw.name)[0]
        if angle_rad < self.settings.empty_below:
            return failed(f"the jaws are closed to {angle_rad:.2f} rad")
        if any(verdict.trouble is not Trouble.SLIP for verdict in self.context.verdicts()):
            return failed("the stone was dropped")
        return succeeded()
