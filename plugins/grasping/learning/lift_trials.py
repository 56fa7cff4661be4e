"""The label of a grasp: the slip of the true stone in a simulated lift with random errors."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.grasping.simulated_lift import OPENED_RAD, SimulatedLift, drawn_offset
from executive_plugins.physics.belief import belief_of
from executive_plugins.physics.scenario import Scenario
from executive_plugins.physics.surface import ContactModel

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.machine.gripper import Gripper

_KIND_FRICTION = (0.4, 0.8)  # in `kind`; in another scenario that of its belief
_DENSITY_KG_M3 = (2300.0, 2900.0)
# Bounds of the gripper's error along and about each axis where none are given. They are wider than
# those of an arm, so that labels tell robust grasps from narrow ones, whatever arm they are for.
SHIFT_M, TURN_RAD = 0.05, float(np.radians(5.0))


@dataclass(frozen=True, slots=True)
class LiftErrors:
    """What one lift has other than planned.

    Attributes:
        T_gripper_arrived: Where the arm brings the gripper, seen from the planned pose, (4, 4).
        mass_kg: Mass of the stone.
        contact: The contacts.
    """

    T_gripper_arrived: Float
    mass_kg: float
    contact: ContactModel


class LiftTrials:
    """Lifts of one stone at rest, each with its own errors of pose, friction and density."""

    def __init__(
        self,
        gripper: Gripper,
        hull: Float,
        scenario: Scenario = "kind",
        shift_m: float = SHIFT_M,
        turn_rad: float = TURN_RAD,
    ) -> None:
        """Prepare lifts of one stone.

        Args:
            gripper: The gripper.
            hull: Corners of the true hull as the stone rests on the ground [m], shape (V, 3).
            scenario: Whose contacts the lifts have.
            shift_m: Largest error of the gripper along each axis [m].
            turn_rad: The same about each axis [rad].
        """
        self._gripper, self._hull = gripper, hull
        self._shift_m, self._turn_rad = shift_m, turn_rad
        self._contacts = belief_of(
            scenario, gripper, _KIND_FRICTION if scenario == "kind" else None
        )
        self._volume_m3, _ = volume_and_centroid(hull)

    def lift(self, T_plan_gripper: Float, jaw_rad: float, rng: np.random.Generator) -> float:
        """Return the slip of the stone in the jaws [m], at most 0.5.

        It is the shift plus the turn at half a metre from the centre, see `Lifted.slip_m`.
        """
        drawn = self.draw(rng)
        up = np.array([0.0, 0.0, 1.0])
        lift = SimulatedLift(self._gripper, self._hull, up, drawn.mass_kg)
        arrived = T_plan_gripper @ drawn.T_gripper_arrived
        return lift.lift(arrived, jaw_rad + OPENED_RAD, drawn.contact).slip_m

    def draw(self, rng: np.random.Generator) -> LiftErrors:
        """Draw the errors of one lift."""
        off = drawn_offset(rng, self._shift_m, self._turn_rad)
        mass_kg = self._volume_m3 * rng.uniform(*_DENSITY_KG_M3)
        contact = self._contacts.contact(float(rng.uniform(*self._contacts.friction)))
        return LiftErrors(off, mass_kg, contact)
