"""Ask the monitors about the held stone."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded


class DetectSlip(Condition):
    """Succeed while no monitor has seen the held stone slip or drop (Mascaro 2020, Sec. 6.3); fail
    with the verdict.

    As the first child of a `reactive_sequence` it cancels the motion beside it the moment that
    trouble is seen.
    """

    needs = ("monitoring",)

    def check(self, **inputs: Any) -> Outcome:
        verdicts = self.context.verdicts()
        if not verdicts:
            return succeeded()
        first = verdicts[0]
        return failed(f"{first.trouble} seen by {first.monitor}: {first.detail}")
