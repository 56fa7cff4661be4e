"""Move along a planned trajectory."""

from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.messages.trajectory import JointTrajectory


class ExecuteTrajectory(Action):
    """Follow a trajectory to its end; when cancelled, the machine stops along the path."""

    needs = (Robot,)
    claims = (Part.ARM, Part.CABIN)

    def run(self, trajectory: JointTrajectory) -> Steps[None]:
        """Follow the trajectory.

        Args:
            trajectory: Joint positions over time.
        """
        return (yield from follow(self.context, trajectory))
