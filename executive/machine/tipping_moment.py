"""The moments about the sides of a machine's area of support, at rest and in motion."""

import numpy as np
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_LOOKS = 40  # postures of a path that are looked at
_STEP_S = 1e-3  # of the difference quotients for the speeds of the links

# Share of what is left until the machine tips that a path with a load may use. As much is for what
# adds to it, a stop in its middle or the sway of the supports, and a fifth for what the model errs:
# it foretells periods of the sway to 8 %, masses to some percent, and takes the machine as level. A
# lean of one degree towards a load at 0.7 of what tips the machine takes a sixth of what is left.
SHARE = 0.4


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
        speeds = (self._places(q + _STEP_S * dq, load_kg)[0] - places_m) / _STEP_S
        sideways = speeds[:, :2] @ self._sides[:, :2].T
        outward = places_m[:, 2:] * sideways - speeds[:, 2:] * self._outward(places_m)
        return np.asarray(masses @ outward)

    def used(self, times_s: Float, positions: Float, velocities: Float, load_kg: float) -> float:
        """Return the largest share of what holds the machine that the motion along a path takes.

        Args:
            times_s: Times of the path [s], shape (m,).
            positions: Of the arm's joints [rad] or [m], shape (m, n).
            velocities: Of them, shape (m, n).
            load_kg: A point mass at the grasp centre [kg].

        Returns:
            That share, 1 if the motion tips the machine; infinite if it tips at rest.
        """
        few = np.unique(np.linspace(0, len(times_s) - 1, _LOOKS).round().astype(int))
        along = zip(positions[few], velocities[few], strict=True)
        momenta = np.array([self.momentum(q, dq, load_kg) for q, dq in along])
        tips = -np.diff(momenta, axis=0) / np.diff(times_s[few])[:, None]
        holding = np.array([self.holding_nm(q, load_kg) for q in positions[few]])
        held = np.minimum(holding[1:], holding[:-1])
        if held.min(initial=np.inf) <= 0.0:
            return np.inf
        return float(np.max(tips / held, initial=0.0))

    def _outward(self, places_m: Float) -> Float:
        """Return how far places are beyond each side [m], shape (k, K)."""
        return np.asarray(places_m[:, :2] @ self._sides[:, :2].T + self._sides[:, 2])

    def _places(self, q: Float, load_kg: float) -> tuple[Float, Float]:
        """Return where the links and the load are, above the supports [m], (k, 3), and masses."""
        frames, links = self._kinematics.frames(q), self._machine.links
        places = [transform(frames[name], np.array(link.com_m)) for name, link in links.items()]
        places.append(transform(frames["gripper"], self._machine.gripper.grasp_centre))
        masses = np.array([*(link.mass_kg for link in links.values()), load_kg])
        return np.array(places) + [0.0, 0.0, self._machine.stance.base_height_m], masses
