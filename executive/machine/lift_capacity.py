"""The lift capacity of a machine by radius and side (ISO 10567): tipping and hydraulic.

ISO 10567 rates an excavator at 75 % of the load that tips it and 87 % of the load that its
hydraulics hold, whichever is less, on firm level ground. Both follow from the masses, the points of
support and the efforts of the machine's description. The load hangs at rest at the grasp centre.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.dynamics import Dynamics
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

TIPPING_SHARE, HYDRAULIC_SHARE = 0.75, 0.87  # ISO 10567:2007, rated lift capacity
_UP = np.array([0.0, 0.0, 1.0])
_HANGS_M, _HANGS = 0.05, 0.3  # largest distance and tilt of the gripper at which it still counts
_LOOKS = 40  # postures of a path whose capacities are compared
_PULL = 0.01  # towards the carrying posture, which resolves redundant freedom


@dataclass(frozen=True, slots=True)
class Capacity:
    """What the machine may lift in one posture.

    Attributes:
        radius_m: Distance of the load from the turning axis.
        azimuth_rad: Direction of the load about the turning axis, from x forwards.
        tipping_kg: Load that tips the machine; infinite over its points of support.
        hydraulic_kg: Load that the weakest joint holds at rest.
        payload_kg: Heaviest load of the gripper.
    """

    radius_m: float
    azimuth_rad: float
    tipping_kg: float
    hydraulic_kg: float
    payload_kg: float

    @property
    def rated_kg(self) -> float:
        """The rated lift capacity [kg]."""
        return min(self._limits_kg().values())

    def refusal(self, mass_kg: float) -> str:
        """Return why a mass may not be lifted; empty if it may."""
        if mass_kg <= self.rated_kg:
            return ""
        limits_kg = self._limits_kg()
        cause = min(limits_kg, key=lambda cause: limits_kg[cause])
        return (
            f"{mass_kg:.0f} kg at {self.radius_m:.1f} m and {np.degrees(self.azimuth_rad):.0f}° "
            f"are beyond the lift capacity of {self.rated_kg:.0f} kg ({cause}, ISO 10567)"
        )

    def _limits_kg(self) -> dict[str, float]:
        """Return the limits [kg] by what sets them."""
        return {
            f"75 % of {self.tipping_kg:.0f} kg that tip the machine": (
                TIPPING_SHARE * self.tipping_kg
            ),
            f"87 % of {self.hydraulic_kg:.0f} kg that its joints hold": (
                HYDRAULIC_SHARE * self.hydraulic_kg
            ),
            "the payload of the gripper": self.payload_kg,
        }


class LiftCapacity:
    """Lift capacities of one machine on firm level ground."""

    def __init__(self, machine: Machine) -> None:
        self._machine, self._kinematics = machine, Kinematics(machine)
        self._dynamics = Dynamics(machine)
        self._limits = np.array([joint.max_effort for joint in machine.joints])
        self._turn = machine.arm_names.index(machine.turn_joint)
        self._hanging: dict[float, Float | None] = {}

    @cached_property
    def _edges(self) -> Float:
        """The sides of the area of support as n·p + d ≤ 0 inside, |n| = 1, shape (K, 3)."""
        return np.asarray(ConvexHull(np.array(self._machine.stance.supports_m)).equations)

    def at(self, q: Float) -> Capacity:
        """Return the capacity in a posture of the arm, shape (n,)."""
        frames = self._kinematics.frames(q)
        load = transform(frames["gripper"], self._machine.gripper.grasp_centre)
        frame = frames[self._machine.cabin_link]
        out = load[:2] - frame[:2, 3]
        return Capacity(
            radius_m=float(np.hypot(*out)),
            azimuth_rad=float(np.arctan2(out[1], out[0])),
            tipping_kg=self._tipping_kg(frames, load),
            hydraulic_kg=self._hydraulic_kg(q),
            payload_kg=self._machine.payload_kg,
        )

    def along(self, positions: Float) -> Capacity:
        """Return the least capacity on a path of the arm, shape (m, n).

        At most 40 postures are looked at, evenly from the first to the last.
        """
        few = np.unique(np.linspace(0, len(positions) - 1, _LOOKS).round().astype(int))
        return min((self.at(q) for q in positions[few]), key=lambda found: found.rated_kg)

    def near(self, radius_m: float, azimuth_rad: float) -> Capacity | None:
        """Return the capacity at a place on the ground, the gripper hanging; None out of reach.

        The radius is rounded up to 0.25 m, so that postures are computed once.
        """
        step = float(np.ceil(radius_m / 0.25 - 1e-9) * 0.25)
        if step not in self._hanging:
            self._hanging[step] = self._hang(step)
        q = self._hanging[step]
        if q is None:
            return None
        turned = q.copy()
        turned[self._turn] += azimuth_rad - self.at(q).azimuth_rad
        return self.at(turned)

    def _tipping_kg(self, frames: dict[str, Float], load: Float) -> float:
        """Balance the moments of all weights about each side of the area of support."""
        if not self._machine.stance.supports_m:
            return np.inf
        outward = self._edges[:, :2] @ load[:2] + self._edges[:, 2]
        holding = np.zeros(len(outward))
        for name, link in self._machine.links.items():
            at = transform(frames[name], np.array(link.com_m))
            holding -= link.mass_kg * (self._edges[:, :2] @ at[:2] + self._edges[:, 2])
        with np.errstate(divide="ignore"):
            loads = np.where(outward > 0, holding / np.maximum(outward, 1e-9), np.inf)
        return float(max(loads.min(), 0.0))

    def _hydraulic_kg(self, q: Float) -> float:
        """Solve |effort of the links + mass · effort of 1 kg| = limit for the least mass."""
        still = np.zeros(len(q))
        links, loaded = (
            self._dynamics.efforts(q, still, still, _UP, load_kg) for load_kg in (0.0, 1.0)
        )
        load = loaded - links
        with np.errstate(divide="ignore", invalid="ignore"):
            most = (np.sign(load) * self._limits - links) / load
        return float(max(np.where(np.abs(load) > 1e-6, most, np.inf).min(), 0.0))

    def _hang(self, radius_m: float) -> Float | None:
        """Return a posture with the gripper hanging over the ground at a radius."""
        start = self._machine.posture("carry")
        ground_m = -self._machine.stance.base_height_m + self._machine.gripper.grasp_centre[0] / 2

        def missed(q: Float) -> Float:
            T = self._kinematics.gripper(q)
            load = transform(T, self._machine.gripper.grasp_centre)
            return np.array([np.hypot(*load[:2]) - radius_m, load[2] - ground_m, *T[:2, 0]])

        lower = np.where(np.isfinite(self._machine.lower), self._machine.lower, start - np.pi)
        upper = np.where(np.isfinite(self._machine.upper), self._machine.upper, start + np.pi)
        found = least_squares(
            lambda q: np.concatenate([missed(q), _PULL * (q - start)]),
            np.clip(start, lower + 1e-6, upper - 1e-6),
            bounds=(lower, upper),
        ).x
        rest = np.abs(missed(found))
        return found if rest[:2].max() < _HANGS_M and rest[2:].max() < _HANGS else None
