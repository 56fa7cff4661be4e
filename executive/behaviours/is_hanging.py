"""Ask whether a held stone hangs free."""

from pydantic import Field

from executive.config import Settings
from executive.interfaces.monitoring import Monitor
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded


class IsHangingSettings(Settings):
    probability: float = Field(
        0.95,
        gt=0.5,
        lt=1,
        description="Probability that the ground carries the stone from which it hangs no more.",
    )


class IsHanging(Condition[IsHangingSettings]):
    """Succeed until a monitor tells that the ground carries the held stone.

    As the first child of a `reactive_sequence` it ends a motion downward where the stone meets the
    ground, wherever that is. A stone that has slipped hangs lower than its estimate, and the plan
    would press it into the ground. Without a monitor that tells, the plan is carried out.
    """

    needs = (Monitor,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        standing = self.context.standing()
        if standing is None:
            return succeeded(reason="no monitor tells whether the ground carries the stone")
        if standing < self.settings.probability:
            return succeeded()
        return failed(f"the ground carries the stone (p = {standing:.2f})")
