"""Ask whether something is in the jaws."""

from pydantic import Field

from executive.config import Radians, Settings
from executive.interfaces.monitoring import Monitor
from executive.leaf.action import Condition
from executive.leaf.closed_jaws import CLOSED_RAD, holds_nothing
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.verdict import Trouble


class IsHoldingSettings(Settings):
    empty_below: Radians = Field(
        CLOSED_RAD,
        ge=0,
        le=1,
        description="Jaws that are closed further than this hold nothing, unless the stone was "
        "found to hang within them [rad].",
    )


class IsHolding(Condition[IsHoldingSettings]):
    """Succeed while the jaws are held apart and no monitor has reported a fall.

    Closed jaws count as held apart from when a trial lift has weighed the stone within them.
    """

    needs = (Monitor,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        if holds_nothing(self.context, self.settings.empty_below):
            angle_rad = self.context.joints().of(self.context.machine().jaw.name)[0]
            return failed(f"the jaws are closed to {angle_rad:.2f} rad")
        if any(verdict.trouble is not Trouble.SLIP for verdict in self.context.verdicts()):
            return failed("the stone was dropped")
        return succeeded()
