"""Ask whether a held stone is where it was to go, though the motion was cut short."""

from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.port import Port
from executive.messages.placement import Placement
from executive.messages.verdict import Trouble


class HasArrivedSettings(Settings):
    aside: Meters = Field(
        0.1, ge=0, le=1, description="Largest horizontal distance from the placement [m]."
    )
    above: Meters = Field(
        0.25, ge=0, le=1, description="Largest height above it [m]: the stone met the ground early."
    )


class HasArrived(Condition):
    """Succeed if the gripper stands at the placement and the stone has not fallen.

    A stone whose lowest point hung deeper than its model knows meets the ground early, shifts in
    the jaws, and looks as if it slipped; it has arrived all the same.
    """

    Settings = HasArrivedSettings
    needs = ("monitoring",)
    inputs = {"placement": Port(Placement, "the placement that was to be carried out")}

    def check(self, **inputs: Any) -> Outcome:
        if any(verdict.trouble is not Trouble.SLIP for verdict in self.context.verdicts()):
            return failed("the stone was dropped")
        gap = self.context.gripper()[:3, 3] - inputs["placement"].T_map_gripper[:3, 3]
        aside_m, above_m = float(np.hypot(gap[0], gap[1])), float(gap[2])
        where = f"{above_m:.2f} m above and {aside_m:.2f} m beside the placement"
        if aside_m > self.settings.aside or above_m > self.settings.above:
            return failed(where)
        self.context.note("arrived_early", aside_m=aside_m, above_m=above_m)
        return succeeded(where)
