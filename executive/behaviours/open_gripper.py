"""Open the jaws."""

from pydantic import Field

from executive.config import Newtons, Radians, Settings
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.jaws import drive_jaws
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded


class OpenGripperSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    tolerance: Radians = Field(
        0.1, gt=0, le=1, description="Jaws that end further from fully open are a failure [rad]."
    )


class OpenGripper(Action[OpenGripperSettings]):
    """Open the jaws fully."""

    needs = (Robot,)
    claims = (Part.JAWS,)
    on_resume = OnResume.REDO
    is_irreversible = True

    def run(self) -> Steps[None]:
        wanted_rad = self.context.machine().gripper.open_rad
        angle_rad = yield from drive_jaws(self.context, wanted_rad, self.settings.force)
        if abs(angle_rad - wanted_rad) > self.settings.tolerance:
            return failed(
                f"the jaws stopped at {angle_rad:.2f} rad and do not open to {wanted_rad:.2f} rad"
            )
        return succeeded()
