"""Ask whether a held stone is at its placement although the motion was cut short."""

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.events.stone import ArrivedEarly
from executive.interfaces.monitoring import Monitor
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.placement import Placement
from executive.messages.verdict import Trouble


class HasArrivedSettings(Settings):
    aside: Meters = Field(
        0.1, ge=0, le=1, description="Largest horizontal distance from the placement [m]."
    )
    above: Meters = Field(
        0.25, ge=0, le=5, description="Largest height above it [m]: the stone met the ground early."
    )


class HasArrived(Condition[HasArrivedSettings]):
    """Succeed if the gripper is at the placement and the stone has not fallen.

    A stone that reaches lower than its model shows meets the ground early and shifts in the jaws,
    which the monitors report as a slip; it has arrived all the same. With a larger `above` this
    asks whether the stone is over its place, and can be set down there.
    """

    needs = (Monitor,)
    on_resume = OnResume.REDO

    def check(self, placement: Placement) -> Outcome[None]:
        """Compare the gripper's pose with the placement.

        Args:
            placement: The placement that was to be carried out.
        """
        verdicts = self.context.verdicts()
        fall = next((one for one in verdicts if one.trouble is not Trouble.SLIP), None)
        if fall is not None:
            return failed(f"the stone was dropped: {fall.detail}")
        gap = self.context.gripper()[:3, 3] - placement.T_map_gripper[:3, 3]
        aside_m, above_m = float(np.hypot(gap[0], gap[1])), float(gap[2])
        where = f"{above_m:.2f} m above and {aside_m:.2f} m beside the placement"
        if aside_m > self.settings.aside or above_m > self.settings.above:
            slip = f", after a slip: {verdicts[0].detail}" if verdicts else ""
            return failed(f"{where}{slip}")
        self.context.record(ArrivedEarly(aside_m, above_m))
        return succeeded(reason=where)
