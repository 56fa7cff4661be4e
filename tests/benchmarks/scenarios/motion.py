"""How the machine moves, in closed form: it is at rest, drives slowly over uneven ground, or swings
its cabin.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import from_rpy


class Kind(StrEnum):
    """What moves, after a rest."""

    STANDING = "standing"
    DRIVING = "driving"
    SWINGING = "swinging"


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion that begins after a rest and goes on.

    Attributes:
        kind: What moves.
        rest_s: Time of rest before [s].
        speed_m_s: Of the drive [m/s]; at most 1.25 times that at the ends of the curves.
        radius_m: Of the drive's rosette [m].
        swing_rad: Angle from one end of the swing to the other [rad].
        period_s: Time to and fro [s].
        phases: What makes one seed differ from another [rad], shape (6,).
    """

    kind: Kind
    rest_s: float
    speed_m_s: float
    radius_m: float
    swing_rad: float
    period_s: float
    phases: tuple[float, ...]

    @classmethod
    def drawn(cls, kind: Kind, rng: np.random.Generator, rest_s: float = 6.0) -> "Motion":
        """Draw one of a kind: drives of 0.5 to 0.75 m/s, swings of 0.5 to 0.8 rad/s at most."""
        period_s = rng.uniform(12.0, 16.0)
        rate_rad_s = rng.uniform(0.5, 0.8)
        return cls(
            kind,
            rest_s,
            speed_m_s=rng.uniform(0.5, 0.75),
            radius_m=rng.uniform(15.0, 25.0),
            swing_rad=rate_rad_s * period_s / np.pi,
            period_s=period_s,
            phases=tuple(rng.uniform(0, 2 * np.pi, 6)),
        )

    def way_m(self, t: Float) -> Float:
        """Return the way driven [m]: the speed rises smoothly within four seconds, shape (n,)."""
        if self.kind != Kind.DRIVING:
            return np.zeros_like(t)
        rise_s = 4.0
        u = np.clip((t - self.rest_s) / rise_s, 0.0, 1.0)
        beyond_s = np.maximum(t - self.rest_s - rise_s, 0.0)
        return self.speed_m_s * (rise_s * (u**3 - u**4 / 2) + beyond_s)

    def p_map_base(self, t: Float) -> Float:
        """Return the chassis on a rosette r = ρ (1 + sin(3φ)/8) over waves of the ground [m], shape
        (n, 3).
        """
        phi = self.way_m(t) / self.radius_m
        r = self.radius_m * (1 + np.sin(3 * phi + self.phases[0]) / 8)
        angle = phi + self.phases[1]
        return np.stack(
            [r * np.cos(angle), r * np.sin(angle), 0.3 * np.sin(4 * phi + self.phases[2])], axis=1
        )

    def R_map_base(self, t: Float) -> Float:
        """Return the chassis along the rosette, rolling and pitching by 2°, shape (n, 3, 3)."""
        way = self.way_m(t)
        phi = way / self.radius_m
        swelling = 1 + np.sin(3 * phi + self.phases[0]) / 8
        outward = 3 * np.cos(3 * phi + self.phases[0]) / 8
        yaw = phi + self.phases[1] + np.arctan2(swelling, outward)
        roll = 0.035 * np.sin(way / 2.5 + self.phases[3])
        pitch = 0.035 * np.sin(way / 3.5 + self.phases[4])
        return np.array([from_rpy(*angles) for angles in zip(roll, pitch, yaw, strict=True)])

    def turn(self, t: Float) -> tuple[Float, Float]:
        """Return angle [rad] and rate [rad/s] of the cabin on the chassis, shape (n,) each."""
        first = self.phases[5] - np.pi
        if self.kind != Kind.SWINGING:
            return np.full_like(t, first), np.zeros_like(t)
        u, w, a = np.maximum(t - self.rest_s, 0.0), 2 * np.pi / self.period_s, self.swing_rad / 2
        return first + a * (1 - np.cos(w * u)), a * w * np.sin(w * u)
