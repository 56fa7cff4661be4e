"""Whether the arm comes to a grasp, at its pose and on the straight way above it, and holds the
stone there.
"""

from functools import cached_property

import numpy as np
from executive_plugins.grasping.feasibility.arm_load import ArmLoad

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import about_axis
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine

_HALF_TURN = pose(
    about_axis(np.array([1.0, 0.0, 0.0]), np.pi)
)  # about the approach: the jaws change places


class ArmReach:
    """Asks the motion planner, from the carrying posture."""

    def __init__(self, machine: Machine, motion: MotionPlanner) -> None:
        self._machine, self._motion = machine, motion
        self._seed = machine.posture("carry")

    @cached_property
    def _load(self) -> ArmLoad:
        return ArmLoad(self._machine)

    def holds(self, T_map_gripper: Float, T_map_base: Float, mass_kg: float) -> bool:
        """Return whether the joints hold a stone of a mass at a pose that the arm comes to."""
        q = self._motion.reach(inverse(T_map_base) @ T_map_gripper, self._seed)
        return q is not None and self._load.can_hold(q, mass_kg)

    def reached(self, T_map_gripper: Float, T_map_base: Float, above_m: float) -> Float | None:
        """Return the pose, or that after half a turn about the approach if the wrist turns less;
        None out of reach.
        """
        T_base_map = inverse(T_map_base)
        ways = {False: T_map_gripper, True: T_map_gripper @ _HALF_TURN}
        found = {
            is_turned: self._motion.reach(T_base_map @ T, self._seed)
            for is_turned, T in ways.items()
        }
        effort = {
            is_turned: abs(float(q[-1] - self._seed[-1]))
            for is_turned, q in found.items()
            if q is not None
        }
        if not effort:
            return None
        T = ways[min(effort, key=lambda is_turned: (effort[is_turned], is_turned))]
        above = pose(t=np.array([0.0, 0.0, above_m])) @ T
        return T if self._motion.reach(T_base_map @ above, self._seed) is not None else None
