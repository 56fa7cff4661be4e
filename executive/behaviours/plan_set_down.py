"""Plan to lower a held stone to the ground below it."""

from executive.geometry.gap import gap_below
from executive.geometry.pose import transform
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.path import PathPlanned
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.request import MoveRequest

_CLEARANCE_M = 0.05  # left between the stone and the ground: the model is a few centimetres off
_LEAST_WAY_M = 0.05


class PlanSetDown(Action):
    """Plan the way straight down for a stone that slips, so that it falls less far."""

    needs = (MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[PathPlanned]:
        """Plan from where the gripper is.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        cloud = surroundings(self.context, hold.stone_id)
        surface = held_surface(self.context, hold)
        goal = self.context.gripper()
        way_m = gap_below(transform(goal, surface), cloud.points) - _CLEARANCE_M
        if way_m < _LEAST_WAY_M:
            return failed("the stone is at the ground already")
        goal[2, 3] -= way_m
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=goal,
            T_map_base=self.context.state().T_map_base,
            leave_m=0.0,
            arrive_m=way_m,
            obstacles=cloud,
            held_gripper=surface,
            jaw_rad=hold.jaw_rad,
        )
        plan = yield from self.context.job(self.context.use(MotionPlanner).move, request)
        if plan.trajectory is None:
            return failed(f"no path down: {plan.reason}")
        return succeeded(PathPlanned(plan.trajectory), f"{way_m:.2f} m down")
