"""Lift a held stone by a little, and see whether the grip bears."""

from pydantic import Field

from executive.config import Meters, Seconds, Settings
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.way_up import risen_m, way_up
from executive.messages.hold import Hold


class TrialLiftSettings(Settings):
    height: Meters = Field(
        0.12,
        gt=0,
        le=1,
        description="Height of the lift [m]: a stone that falls from there stays on its side, as "
        "long as this is a small part of its width.",
    )
    wait: Seconds = Field(
        0.4,
        ge=0,
        le=10,
        description="Time for which the stone hangs there [s]: a monitor tells a fall within half "
        "a second, and most begin on the way up.",
    )


class TrialLift(Action[TrialLiftSettings]):
    """Lift a held stone off the ground by a little and wait, before it is raised.

    Beside `DetectSlip` in a `reactive_sequence`, as riggers do with any load. A grip that does not
    bear gives way at once: of 31 stones that were lost in six missions, 28 had slid by 5 cm in the
    jaws before the gripper was 0.15 m up. They were raised on, and half of them turned over as they
    fell, so that the side that was known lay below and the next grasp was planned on one view.
    """

    needs = (Robot, Mapper, MotionPlanner, ObjectDatabase)
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[None]:
        """Lift and wait.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        way_m = self.settings.height - risen_m(self.context, hold)
        if way_m <= 0:
            return succeeded(reason="it hangs higher already")
        plan = yield from way_up(self.context, hold, way_m)
        if plan.trajectory is None:
            return succeeded(reason=f"not tried, no path up: {plan.reason}")
        lifted = yield from follow(self.context, plan.trajectory)
        if not lifted.success:
            return lifted
        since_s = self.context.now_s()
        while self.context.now_s() - since_s < self.settings.wait:
            yield None
        return succeeded(reason=f"it hangs {self.settings.height:.2f} m up")
