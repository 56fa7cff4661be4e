"""The label of a grasp: the slip of the true stone in a simulated lift with random errors."""

import numpy as np
from executive_plugins.grasping.simulated_lift import SimulatedLift

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

_SHIFT_M, _TURN_RAD = 0.05, np.radians(5.0)  # bounds of the arm's error per axis
_FRICTION = (0.4, 0.8)
_DENSITY_KG_M3 = (2300.0, 2900.0)
_OPENED_RAD = 0.15  # the jaws start this much wider than planned, to allow for the errors
LIFTED_M = 0.2  # a stone that slips more is lost, or will be


class LiftTrials:
    """Lifts of one stone at rest, each with its own errors of pose, friction and density."""

    def __init__(self, gripper: Gripper, hull: Float) -> None:
        """Take the corners of the true hull as the stone rests on the ground [m], shape (V, 3)."""
        self._gripper, self._hull = gripper, hull
        self._volume_m3, _ = volume_and_centroid(hull)

    def lift(self, T_plan_gripper: Float, jaw_rad: float, rng: np.random.Generator) -> float:
        """Return the slip of the stone in the jaws [m], at most 0.5.

        It is the shift plus the turn at half a metre from the centre, see `Lifted.slip_m`.
        """
        turn, shift = rng.uniform(-_TURN_RAD, _TURN_RAD, 3), rng.uniform(-_SHIFT_M, _SHIFT_M, 3)
        off = pose(exp_so3(turn), shift)
        mass_kg = self._volume_m3 * rng.uniform(*_DENSITY_KG_M3)
        up = np.array([0.0, 0.0, 1.0])
        return (
            SimulatedLift(self._gripper, self._hull, up, mass_kg)
            .lift(T_plan_gripper @ off, jaw_rad + _OPENED_RAD, float(rng.uniform(*_FRICTION)))
            .slip_m
        )
