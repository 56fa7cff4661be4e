"""Open the jaws."""

from typing import Any

from pydantic import Field

from executive.config import Newtons, Radians, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.jaws import drive_jaws
from executive.leaf.outcome import failed, succeeded


class OpenGripperSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    tolerance: Radians = Field(
        0.1, gt=0, le=1, description="Standing wider than this off fully open is a failure [rad]."
    )


class OpenGripper(Action):
    """Open the jaws fully."""

    Settings = OpenGripperSettings
    needs = ("robot",)

    def run(self, **inputs: Any) -> Steps:
        wanted = self.context.machine().gripper.open_rad
        angle = yield from drive_jaws(self.context, wanted, self.settings.force)
        if abs(angle - wanted) > self.settings.tolerance:
            return failed(f"the jaws stand at {angle:.2f} rad and do not open to {wanted:.2f} rad")
        return succeeded()
