"""The moments about the sides of a machine's area of support, at rest and in motion."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_LOOK_S = 0.15  # between postures of a motion that are looked at: accelerations last longer
_FEWEST_LOOKS = 8
_STEP_S = 0.02  # of the moments along a motion: a thirtieth of the quickest sway
_DIFFERENCE_S = 1e-3  # of the difference quotients for the speeds of the links
# A load that tips the machine, by a deviation or two of its weight, is moved as if it left so much
# of what holds the empty machine: whoever carries it judges whether it may be.
_LEFT = 0.1

# Share of what is left until the machine tips that a path with a load may use. As much is for what
# adds to it, a stop in its middle or the sway of the supports, and a fifth for what the model errs:
# it foretells periods of the sway to 8 %, masses to some percent, and takes the machine as level. A
# lean of one degree towards a load at 0.7 of what tips the machine takes a sixth of what is left.
SHARE = 0.4


@dataclass(frozen=True, slots=True, eq=False)
class MotionMoments:
    """Moments about each side of the area of support along a motion.

    Attributes:
        step_s: Time between two rows [s].
        tipping_nm: By the accelerations of the motion, shape (m, K); negative where they hold.
        holding_nm: By the weights at rest, at least a tenth of those of the empty machine, (m, K).
    """

    step_s: float
    tipping_nm: Float
    holding_nm: Float


class TippingMoment:
    """What holds a machine with a load on its supports, and what its motion takes from that.

    Args:
        machine: The machine, with its points of support.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._kinematics = machine, Kinematics(machine)
        # The sides as n·p + d ≤ 0 inside, |n| = 1.
        self._sides = np.asarray(ConvexHull(np.array(machine.stance.supports_m)).equations)

    def holding_nm(self, q: Float, load_kg: float) -> Float:
        """Return the moments that hold the machine at rest about each side [N·m], shape (K,).

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            load_kg: A point mass at the grasp centre [kg].
        """
        places_m, masses = self._places(q, load_kg)
        return np.asarray(-GRAVITY_M_S2 * masses @ self._outward(places_m))

    def tipping_nm(self, q: Float, force_n: Float) -> Float:
        """Return the moments by which a force on the tool tips the machine about each side, (K,).

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            force_n: The force at the grasp centre, in axes of the base [N], shape (3,).
        """
        place_m = self._places(q, 0.0)[0][-1:]
        sideways = self._sides[:, :2] @ force_n[:2]
        return np.asarray(place_m[0, 2] * sideways - force_n[2] * self._outward(place_m)[0])

    def momentum(self, q: Float, dq: Float, load_kg: float) -> Float:
        """Return the momentum of all masses about each side, outwards positive [N·m·s], (K,).

        Its loss within a time tips the machine by that moment, and its gain holds it.

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            dq: Their velocities, shape (n,).
            load_kg: A point mass at the grasp centre [kg].
        """
        places_m, masses = self._places(q, load_kg)
        ahead_m, _ = self._places(q + _DIFFERENCE_S * dq, load_kg)
        speeds = (ahead_m - places_m) / _DIFFERENCE_S
        sideways = speeds[:, :2] @ self._sides[:, :2].T
        outward = places_m[:, 2:] * sideways - speeds[:, 2:] * self._outward(places_m)
        return np.asarray(masses @ outward)

    def along(self, times_s: Float, positions: Float, load_kg: float) -> MotionMoments:
        """Return by how much a motion from rest to rest tips the machine, and what holds it.

        Args:
            times_s: Times of the motion [s], shape (m,).
            positions: Of the arm's joints [rad] or [m], shape (m, n).
            load_kg: A point mass at the grasp centre [kg].
        """
        looks = int(np.clip(np.ceil(times_s[-1] / _LOOK_S), _FEWEST_LOOKS, len(times_s) - 1))
        few = np.unique(np.linspace(0, len(times_s) - 1, looks + 1).round().astype(int))
        seen = [self._places(q, load_kg) for q in positions[few]]
        way = CubicSpline(times_s[few], np.array([places_m for places_m, _ in seen]), 0, "clamped")
        masses, at_s = seen[0][1], np.arange(0.0, times_s[-1], _STEP_S)
        places_m, accelerations = way(at_s), way(at_s, 2)
        outward = self._outward(places_m)
        sideways = accelerations[..., :2] @ self._sides[:, :2].T
        tipping = accelerations[..., 2:] * outward - places_m[..., 2:] * sideways
        weights_n = GRAVITY_M_S2 * masses
        empty_nm = -np.einsum("i,mik->mk", weights_n[:-1], outward[:, :-1])
        loaded_nm = empty_nm - weights_n[-1] * outward[:, -1]
        return MotionMoments(
            step_s=_STEP_S,
            tipping_nm=np.einsum("i,mik->mk", masses, tipping),
            holding_nm=np.maximum(loaded_nm, _LEFT * empty_nm),
        )

    def _outward(self, places_m: Float) -> Float:
        """Return how far places are beyond each side [m], shape (..., K)."""
        return np.asarray(places_m[..., :2] @ self._sides[:, :2].T + self._sides[:, 2])

    def _places(self, q: Float, load_kg: float) -> tuple[Float, Float]:
        """Return where the links and the load are, above the supports [m], (k, 3), and masses."""
        frames, links = self._kinematics.frames(q), self._machine.links
        places = [transform(frames[name], np.array(link.com_m)) for name, link in links.items()]
        places.append(transform(frames["gripper"], self._machine.gripper.grasp_centre))
        masses = np.array([*(link.mass_kg for link in links.values()), load_kg])
        return np.array(places) + [0.0, 0.0, self._machine.stance.base_height_m], masses
