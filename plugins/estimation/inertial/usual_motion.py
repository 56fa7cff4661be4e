"""How strongly a body usually accelerates and turns, by its own samples."""

import math

import numpy as np
from numba import njit, types

from executive.arrays import Float

_MEMORY_S = 20.0  # of the mean squares
PERIOD_S = 0.1  # between two samples that count: motion is slower, and each costs time
# A machine that was at rest so far may begin to move: an excavator's cabin turns by this rate, and
# its chassis accelerates by this much.
_LEAST_ACCELERATION_M_S2, _LEAST_RATE_RAD_S = 1.0, 0.8
_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MEMORY = types.float64[::1]


class UsualMotion:
    """Running mean squares of acceleration and angular velocity, per axis.

    They tell what a body may do during a gap in its samples: it goes on as it did before.
    """

    def __init__(self, memory: Float) -> None:
        """Begin without samples; they are taken by `add_motion`.

        Args:
            memory: Where compiled code keeps the numbers, shape (3,).
        """
        self._memory = memory
        memory[:] = _LEAST_ACCELERATION_M_S2**2, _LEAST_RATE_RAD_S**2, -np.inf

    @property
    def acceleration_m_s2(self) -> float:
        """Standard deviation of the acceleration along an axis, no less than a machine's."""
        return float(usual_acceleration(self._memory))

    @property
    def rate_rad_s(self) -> float:
        """Standard deviation of the angular velocity about an axis, no less than a machine's."""
        return float(usual_rate(self._memory))

    @property
    def step(self) -> tuple[float, float]:
        """Standard deviations of angular velocity [rad/s] and acceleration [m/s²] along an axis."""
        return self.rate_rad_s, self.acceleration_m_s2


@njit(types.float64(_MEMORY), cache=True)  # type: ignore[untyped-decorator]
def usual_acceleration(memory: Float) -> float:
    """Do what `UsualMotion.acceleration_m_s2` does, with its memory."""
    return max(math.sqrt(memory[0]), _LEAST_ACCELERATION_M_S2)


@njit(types.float64(_MEMORY), cache=True)  # type: ignore[untyped-decorator]
def usual_rate(memory: Float) -> float:
    """Do what `UsualMotion.rate_rad_s` does, with its memory."""
    return max(math.sqrt(memory[1]), _LEAST_RATE_RAD_S)


@njit(types.void(_MEMORY, types.float64, _VECTOR, _VECTOR), cache=True)  # type: ignore[untyped-decorator]
def add_motion(memory: Float, stamp_s: float, acceleration: Float, rate: Float) -> None:
    """Take a sample into the memory of a `UsualMotion`, unless it follows too soon.

    Args:
        memory: The memory, shape (3,).
        stamp_s: Time of the sample [s].
        acceleration: [m/s²], shape (3,).
        rate: Angular velocity [rad/s], shape (3,).
    """
    since_s = stamp_s - memory[2]
    if not since_s >= PERIOD_S:
        return
    weight = min(1.0, since_s / _MEMORY_S) if math.isfinite(since_s) else 0.0
    memory[2] = stamp_s
    a, w = acceleration, rate
    memory[0] += weight * ((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) / 3 - memory[0])
    memory[1] += weight * ((w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) / 3 - memory[1])
