"""Close the jaws on a stone."""

from dataclasses import dataclass

from pydantic import Field

from executive.config import Meters, Newtons, Radians, Settings
from executive.events.stone import JawsClosedOnNothing, StoneGrasped
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.closed_jaws import CLOSED_RAD, within
from executive.leaf.jaws import drive_jaws
from executive.leaf.light_jaws import drive_lightly
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.removal import removal_radius, remove_from_map
from executive.messages.hold import Hold
from executive.messages.stone import StoneState


class CloseGripperSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    empty_below: Radians = Field(
        CLOSED_RAD,
        ge=0,
        le=1,
        description="Jaws that close further hold nothing, unless a stone hangs within them [rad].",
    )
    removal_radius: Meters = Field(
        1.0, gt=0, le=3, description="R_obj: least radius that is removed from the map [m]."
    )


@dataclass(frozen=True, slots=True)
class StoneHeld:
    """A stone is in the jaws.

    Attributes:
        hold: Which stone is held, and how.
    """

    hold: Hold


class CloseGripper(Action[CloseGripperSettings]):
    """Close the jaws; if they hold something, inform the database, the map and the monitors.

    Mascaro et al. 2020, Sec. 4.5: the gripper's pose is stored with the stone, and a sphere of
    R_obj = 1 m is removed from the map, see `removal`. If the jaws press on the ground so hard that
    they lift the machine, the gripper is raised before they go on; while what they lift would tip a
    machine that sways on its supports, they wait. Jaws that have closed whole may have met below a
    small stone, and are raised by 0.15 m to weigh whether a part of it hangs within them. Without a
    monitor that weighs they hold nothing.
    """

    needs = (Robot, MotionPlanner, ObjectDatabase, Mapper, Monitor)
    claims = (Part.JAWS, Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO
    is_irreversible = True

    def run(self, stone: int) -> Steps[StoneHeld]:
        """Close, and fail if nothing is between the jaws.

        Args:
            stone: Id of the stone.
        """
        force_n = self.settings.force
        drive = yield from drive_lightly(self.context, 0.0, force_n, stone)
        angle_rad = drive.angle_rad
        if not drive.is_whole:  # the stone is to be carried: it is gripped all the same
            angle_rad = yield from drive_jaws(self.context, 0.0, force_n)
        hold = Hold(stone, self.context.gripper(), angle_rad)
        if angle_rad < self.settings.empty_below and (
            nothing := (yield from within(self.context, stone))
        ):
            reason = f"the jaws closed to {angle_rad:.2f} rad: {nothing}"
            self.context.record(JawsClosedOnNothing(stone, reason))
            return failed(reason)
        objects = self.context.use(ObjectDatabase)
        held = objects.stone(stone)
        if held.state is not StoneState.HELD:  # as it is when a run is resumed after the grasp
            held = objects.grasp(stone, hold.T_map_gripper, self.context.now_s())
        removed, put_back = remove_from_map(self.context, held, self.settings.removal_radius)
        self.context.use(Mapper).mask_held(removal_radius(held))
        self.context.begin_hold()
        self.context.record(StoneGrasped(stone, angle_rad, removed, put_back))
        return succeeded(StoneHeld(hold), drive.told)
