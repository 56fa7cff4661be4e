"""Ask the monitors about the held stone."""

from executive.interfaces.monitoring import Monitor
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded


class DetectSlip(Condition):
    """Succeed while no monitor has reported that the held stone slipped or fell.

    As the first child of a `reactive_sequence` it cancels the motion beside it in the tick in which
    a monitor reports trouble.

    Source: Mascaro et al. 2020, Sec. 6.3.
    """

    needs = (Monitor,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        verdicts = self.context.verdicts()
        if not verdicts:
            return succeeded()
        first = verdicts[0]
        return failed(f"{first.trouble} reported by {first.monitor}: {first.detail}")
