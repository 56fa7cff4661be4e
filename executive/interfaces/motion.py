"""Motion planning: poses of the gripper to joint trajectories."""

from abc import ABC, abstractmethod

import numpy as np

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.request import Around, MotionPlan, MoveRequest, PostureRequest


class MotionPlanner(Plugin, ABC):
    """Plan arm motions without collisions (Mascaro 2020, Sec. 6.1)."""

    capability = "motion"

    @abstractmethod
    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        """Return joint positions near a seed that bring the gripper there, or None, shape (n,)."""

    @abstractmethod
    def move(self, request: MoveRequest) -> MotionPlan:
        """Plan a motion of the gripper from rest to rest; deterministic. It may be slow: a job.

        Returns:
            A trajectory of all arm joints within their limits, or None with the reason, such as a
            goal out of reach or a collision.

        Raises:
            DataError: If the start has another number of joints than the arm.
        """

    @abstractmethod
    def swing(
        self, start: Float, angle_rad: float, duration_s: float, around: Around | None = None
    ) -> MotionPlan:
        """Plan a sweep of the cabin to +angle/2, −angle/2 and back with the arm folded.

        Args:
            start: Present positions of the arm's joints, shape (n,).
            angle_rad: Total angle of the sweep.
            duration_s: Least duration of the sweep [s].
            around: What must not be touched; None if nothing is known.

        Returns:
            A trajectory of all arm joints within their limits, or None with the reason, such as a
            wall within the sweep.
        """

    def move_joints(self, request: PostureRequest) -> MotionPlan:
        """Plan a motion of the joints from rest to rest; deterministic. It may be slow: a job.

        A planner that does not override this refuses every such motion.

        Returns:
            A trajectory of all arm joints within their limits that ends at the goal, or None with
            the reason. A continuous joint may end whole turns away from the goal.

        Raises:
            DataError: If the start has another number of joints than the arm.
        """
        reason = f"{type(self).__name__} plans no motion to joint positions"
        return MotionPlan(None, reason, np.zeros((0, 3)))
