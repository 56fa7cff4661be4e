"""How a machine on supports that yield sways and sinks with a load in its gripper.

Each point of support is a spring along the vertical that pushes and never pulls. A support that the
load lifts off the ground bears nothing any more, so that the machine stands on softer ground: above
a corner, the one across is in the air with half of the load that tips the machine.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.lean import support_rows
from executive.machine.machine import Machine
from executive.machine.stance import SLOWEST_S

# A load that sways presses by a fifth more than it weighs, and lifts supports off by that.
_SWAYING = 1.2
# Period of the arm's drives with a load [s], of 4 Hz: that for which `held_ramp` of motion is made.
_ARM_S = 0.25
_FEWEST = 3  # supports on which a machine stands; on fewer it tips
_NOTHING = 1e-9  # share of the weight by which rounding may make a support pull


@dataclass(frozen=True, slots=True, eq=False)
class _Standing:
    """Springs and masses of a machine in one posture, for its heave and its turns about x and y.

    Attributes:
        stiffness: Of the supports that bear something, shape (3, 3).
        mass: Of links and load, shape (3, 3).
        load_row: By how much the load goes up with each of the three, shape (3,).
    """

    stiffness: Float
    mass: Float
    load_row: Float


class Sway:
    """The sway of one machine by its masses and the stiffness of its supports.

    Args:
        machine: The machine; without a stiffness of its supports it neither sways nor sinks.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._kinematics = machine, Kinematics(machine)
        self._rows = support_rows(machine.stance)
        self._support_n_m = machine.stance.support_n_m or 0.0  # of each; 0 yields nowhere

    def period_s(self, q: Float, load_kg: float) -> float:
        """Return the period of the slowest sway [s], at most `SLOWEST_S`.

        The sway of the supports and that of the arm add by their squares, as those of springs in a
        row do.

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            load_kg: A point mass at the grasp centre [kg].

        Source: Dunkerley's formula, as in S. Timoshenko, Vibration Problems in Engineering, 1937.
        """
        if not self._support_n_m:
            return 0.0
        stands = self._standing(q, load_kg, _SWAYING)
        slowest = float(eigh(stands.stiffness, stands.mass, eigvals_only=True)[0])
        if slowest <= (2 * np.pi / SLOWEST_S) ** 2:
            return SLOWEST_S
        return float(min(np.hypot(2 * np.pi / np.sqrt(slowest), _ARM_S), SLOWEST_S))

    def sink_m(self, q: Float, load_kg: float) -> float:
        """Return how far the gripper goes down as a load comes on [m].

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            load_kg: The load, which hangs at the grasp centre [kg].
        """
        if not self._support_n_m:
            return 0.0
        stands = self._standing(q, load_kg, 1.0)
        yields = np.linalg.pinv(stands.stiffness, hermitian=True) @ stands.load_row
        return float(GRAVITY_M_S2 * load_kg * stands.load_row @ yields)

    def _standing(self, q: Float, load_kg: float, pressing: float) -> _Standing:
        """Return the springs and masses, with a load that presses by a multiple of its weight."""
        frames = self._kinematics.frames(q)
        below_m = self._machine.stance.base_height_m
        mass, weight = np.zeros((3, 3)), np.zeros(3)
        for name, link in self._machine.links.items():
            R = frames[name][:3, :3]
            x, y, z = transform(frames[name], np.array(link.com_m))
            turned = (R * link.inertia_diagonal) @ R.T
            mass += link.mass_kg * _motion(x, y, z + below_m)
            mass[1:, 1:] += turned[:2, :2]
            weight += link.mass_kg * np.array([1.0, y, -x])
        x, y, z = transform(frames["gripper"], self._machine.gripper.grasp_centre)
        row = np.array([1.0, y, -x])
        rows = self._bearing(weight + pressing * load_kg * row)
        stiffness = self._support_n_m * rows.T @ rows
        return _Standing(stiffness, mass + load_kg * _motion(x, y, z + below_m), row)

    def _bearing(self, weight: Float) -> Float:
        """Return the rows of the supports that bear a part of a weight, shape (L, 3).

        Args:
            weight: Sum of all masses, and of their moments about x and y, shape (3,).
        """
        rows = self._rows
        while len(rows) >= _FEWEST:
            loads = np.linalg.pinv(rows.T) @ weight
            if loads.min() >= -_NOTHING * weight[0]:
                break
            rows = np.delete(rows, loads.argmin(), axis=0)
        return rows


def _motion(x: float, y: float, z: float) -> Float:
    """Return the mass matrix of 1 kg at a point, z above the supports, shape (3, 3).

    Its velocity is that of the heave and of the turns about x and y through the supports.
    """
    J = np.array([[0.0, 0.0, z], [0.0, -z, 0.0], [1.0, y, -x]])
    return np.asarray(J.T @ J)
