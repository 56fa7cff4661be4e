"""Whether the arm reaches a grasp and the point above it, and can hold the stone there."""

from functools import cached_property

import numpy as np
from executive_plugins.grasping.feasibility.arm_load import ArmLoad

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import about_axis
from executive.interfaces.motion import MotionPlanner
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine

# Half a turn about the approach exchanges the jaws.
_HALF_TURN = pose(about_axis(np.array([1.0, 0.0, 0.0]), np.pi))


class ArmReach:
    """Queries the motion planner, starting from the carrying posture."""

    def __init__(self, machine: Machine, motion: MotionPlanner) -> None:
        self._machine, self._motion = machine, motion
        self._seed = machine.posture("carry")

    @cached_property
    def _load(self) -> ArmLoad:
        return ArmLoad(self._machine)

    def holds(self, T_map_gripper: Float, T_map_base: Float, mass_kg: float) -> bool:
        """Return whether the arm reaches a pose and its joints can hold a stone of a mass there."""
        q = self._motion.reach(inverse(T_map_base) @ T_map_gripper, self._seed)
        return q is not None and self._load.can_hold(q, mass_kg)

    @cached_property
    def _capacity(self) -> LiftCapacity:
        return LiftCapacity(self._machine)

    def refusal(self, T_map_gripper: Float, T_map_base: Float, mass_kg: float) -> str:
        """Return why a mass may not be lifted at a pose (ISO 10567); empty if it may.

        The machine is taken to stand level.
        """
        q = self._motion.reach(inverse(T_map_base) @ T_map_gripper, self._seed)
        return "out of reach" if q is None else self._capacity.at(q).refusal(mass_kg)

    def reached(self, T_map_gripper: Float, T_map_base: Float, above_m: float) -> Float | None:
        """Return the pose, or the pose half a turn about the approach if the wrist turns less.

        Returns None if neither it nor the pose above it is in reach.
        """
        T_base_map = inverse(T_map_base)
        poses = {False: T_map_gripper, True: T_map_gripper @ _HALF_TURN}
        found = {
            is_turned: self._motion.reach(T_base_map @ T, self._seed)
            for is_turned, T in poses.items()
        }
        wrist_turn = {
            is_turned: abs(float(q[-1] - self._seed[-1]))
            for is_turned, q in found.items()
            if q is not None
        }
        if not wrist_turn:
            return None
        T = poses[min(wrist_turn, key=lambda is_turned: (wrist_turn[is_turned], is_turned))]
        above = pose(t=np.array([0.0, 0.0, above_m])) @ T
        return T if self._motion.reach(T_base_map @ above, self._seed) is not None else None
