"""Desired joint positions and velocities over time."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float, checked
from executive.errors import ShapeError


@dataclass(frozen=True, slots=True, eq=False)
class JointTrajectory:
    """Samples of a smooth motion, between which cubic Hermite interpolation holds.

    Attributes:
        names: The n joints that move; the others hold their positions.
        times_s: Time since the start [s], rising from 0, shape (m,).
        position: [rad] or [m], shape (m, n).
        velocity: [rad/s] or [m/s], shape (m, n).
    """

    names: tuple[str, ...]
    times_s: Float
    position: Float
    velocity: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "times_s", checked("times_s", self.times_s, None))
        shape = (len(self.times_s), len(self.names))
        object.__setattr__(self, "position", checked("position", self.position, *shape))
        object.__setattr__(self, "velocity", checked("velocity", self.velocity, *shape))
        if not len(self.times_s) or self.times_s[0] != 0.0 or not (np.diff(self.times_s) > 0).all():
            raise ShapeError("times_s must rise strictly from 0")

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.times_s[-1])

    def slowed(self, factor: float) -> "JointTrajectory":
        """Return the same path, slower by a factor."""
        times_s, velocity = self.times_s * factor, self.velocity / factor
        return JointTrajectory(self.names, times_s, self.position, velocity)

    def at(self, time_s: float) -> tuple[Float, Float]:
        """Return position and velocity at a time since the start, each of shape (n,).

        Outside the trajectory, the joints rest at the position of its nearer end.
        """
        times = self.times_s
        if time_s <= 0.0 or len(times) == 1:
            return self.position[0], self.velocity[0] * (time_s >= 0.0)
        if time_s >= times[-1]:
            return self.position[-1], np.zeros(len(self.names))
        i = int(np.searchsorted(times, time_s, side="right")) - 1
        h = float(times[i + 1] - times[i])
        u = (time_s - float(times[i])) / h
        p0, p1, v0, v1 = (
            self.position[i],
            self.position[i + 1],
            self.velocity[i],
            self.velocity[i + 1],
        )
        position = (
            (1 + 2 * u) * (1 - u) ** 2 * p0 + u * (1 - u) ** 2 * h * v0 + u**2 * (3 - 2 * u) * p1
        )
        position = position + u**2 * (u - 1) * h * v1
        slope = 6 * u * (1 - u) * (p1 - p0) / h + (1 - u) * (1 - 3 * u) * v0 + u * (3 * u - 2) * v1
        return position, slope
