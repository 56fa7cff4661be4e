"""The label of a grasp: the slip of the true stone in a simulated lift with random errors."""

import numpy as np
from executive_plugins.grasping.simulated_lift import SimulatedLift
from executive_plugins.physics.belief import belief_of
from executive_plugins.physics.scenario import Scenario

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

_SHIFT_M, _TURN_RAD = 0.05, np.radians(5.0)  # bounds of the arm's error per axis
_KIND_FRICTION = (0.4, 0.8)  # in `kind`; in another scenario that of its belief
_DENSITY_KG_M3 = (2300.0, 2900.0)
_OPENED_RAD = 0.15  # the jaws start this much wider than planned, to allow for the errors
LIFTED_M = 0.2  # a stone that slips more is lost, or will be


class LiftTrials:
    """Lifts of one stone at rest, each with its own errors of pose, friction and density."""

    def __init__(self, gripper: Gripper, hull: Float, scenario: Scenario = "kind") -> None:
        """Prepare lifts of one stone.

        Args:
            gripper: The gripper.
            hull: Corners of the true hull as the stone rests on the ground [m], shape (V, 3).
            scenario: Whose contacts the lifts have.
        """
        self._gripper, self._hull = gripper, hull
        self._contacts = belief_of(
            scenario, gripper, _KIND_FRICTION if scenario == "kind" else None
        )
        self._volume_m3, _ = volume_and_centroid(hull)

    def lift(self, T_plan_gripper: Float, jaw_rad: float, rng: np.random.Generator) -> float:
        """Return the slip of the stone in the jaws [m], at most 0.5.

        It is the shift plus the turn at half a metre from the centre, see `Lifted.slip_m`.
        """
        turn, shift = rng.uniform(-_TURN_RAD, _TURN_RAD, 3), rng.uniform(-_SHIFT_M, _SHIFT_M, 3)
        off = pose(exp_so3(turn), shift)
        mass_kg = self._volume_m3 * rng.uniform(*_DENSITY_KG_M3)
        up = np.array([0.0, 0.0, 1.0])
        contact = self._contacts.contact(float(rng.uniform(*self._contacts.friction)))
        lift = SimulatedLift(self._gripper, self._hull, up, mass_kg)
        return lift.lift(T_plan_gripper @ off, jaw_rad + _OPENED_RAD, contact).slip_m
