"""Swing the cabin with the lidars on."""

from pydantic import Field

from executive.config import Radians, Seconds, Settings
from executive.events.site import SiteScanned
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.messages.command import SwitchLidars


class ScanSwingSettings(Settings):
    angle: Radians = Field(2.094, gt=0, le=6.3, description="Whole angle of the sweep [rad].")
    duration: Seconds = Field(20.0, gt=0, le=300, description="Least duration of the sweep [s].")


class ScanSwing(Action[ScanSwingSettings]):
    """Map the surroundings by swinging the cabin about its present heading.

    Source: Mascaro et al. 2020, Sec. 6.2.
    """

    needs = (Robot, Mapper, MotionPlanner)
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)

    def run(self) -> Steps[None]:
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        plan = yield from self.context.job(
            self.context.use(MotionPlanner).swing,
            self.context.arm(),
            self.settings.angle,
            self.settings.duration,
        )
        if plan.trajectory is None:
            return failed(f"no swing: {plan.reason}")
        robot = self.context.use(Robot)
        robot.command(SwitchLidars(True))
        try:
            outcome = yield from follow(self.context, plan.trajectory)
        finally:
            robot.command(SwitchLidars(False))
        cloud = self.context.use(Mapper).cloud()
        self.context.record(SiteScanned(len(cloud)))
        self.context.show("map", cloud)
        if not outcome.success:
            return outcome
        return succeeded(reason=f"{len(cloud)} points in the map")
