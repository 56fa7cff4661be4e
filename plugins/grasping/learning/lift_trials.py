"""What a grasp is labelled with: whether a lift of the true stone succeeds when nothing is quite as
planned.
"""

import numpy as np
from executive_plugins.grasping.simulated_lift import SimulatedLift

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

_SHIFT_M, _TURN_RAD = 0.05, np.radians(5.0)  # of the arm: bounds along each axis of the gripper
_FRICTION = (0.4, 0.8)
_DENSITY_KG_M3 = (2300.0, 2900.0)
_OPENED_RAD = 0.15  # the jaws start this much wider than planned contact, for a pose that is off
LIFTED_M = 0.2  # a stone that moves more in the jaws is lost or about to be


class LiftTrials:
    """Lifts of one stone at rest, each with noise of its own on pose, friction and density."""

    def __init__(self, gripper: Gripper, hull: Float) -> None:
        """Take the true hull's corners where the stone rests on the ground [m], shape (V, 3)."""
        self._gripper, self._hull = gripper, hull
        self._volume_m3, _ = volume_and_centroid(hull)

    def lift(self, T_plan_gripper: Float, jaw_rad: float, rng: np.random.Generator) -> float:
        """Return how far the stone moves in the jaws, its turn at half a metre included, at most
        0.5 [m].
        """
        turn, shift = rng.uniform(-_TURN_RAD, _TURN_RAD, 3), rng.uniform(-_SHIFT_M, _SHIFT_M, 3)
        off = pose(exp_so3(turn), shift)
        mass_kg = self._volume_m3 * rng.uniform(*_DENSITY_KG_M3)
        rehearsal = SimulatedLift(self._gripper, self._hull, np.array([0.0, 0.0, 1.0]), mass_kg)
        return rehearsal.lift(
            T_plan_gripper @ off, jaw_rad + _OPENED_RAD, float(rng.uniform(*_FRICTION))
        ).slip_m
