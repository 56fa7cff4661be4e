"""How strongly a body usually accelerates and turns, by its own samples."""

import numpy as np

from executive.arrays import Float

_MEMORY_S = 20.0  # of the mean squares
_PERIOD_S = 0.1  # between two samples that count: motion is slower, and each costs time
# A machine that was at rest so far may begin to move: an excavator's cabin turns by this rate, and
# its chassis accelerates by this much.
_LEAST_ACCELERATION_M_S2, _LEAST_RATE_RAD_S = 1.0, 0.8


class UsualMotion:
    """Running mean squares of acceleration and angular velocity, per axis.

    They tell what a body may do during a gap in its samples: it goes on as it did before.
    """

    def __init__(self) -> None:
        self._acceleration2 = _LEAST_ACCELERATION_M_S2**2
        self._rate2 = _LEAST_RATE_RAD_S**2
        self._at_s = -np.inf

    def is_due(self, stamp_s: float) -> bool:
        """Return whether a sample of that time counts."""
        return stamp_s - self._at_s >= _PERIOD_S

    def add(self, stamp_s: float, acceleration: Float, rate: Float) -> None:
        """Take acceleration [m/s²] and angular velocity [rad/s] at a time, shapes (3,)."""
        weight = min(1.0, (stamp_s - self._at_s) / _MEMORY_S) if np.isfinite(self._at_s) else 0.0
        self._at_s = stamp_s
        square = float(acceleration @ acceleration) / 3
        self._acceleration2 += weight * (square - self._acceleration2)
        self._rate2 += weight * (float(rate @ rate) / 3 - self._rate2)

    @property
    def acceleration_m_s2(self) -> float:
        """Standard deviation of the acceleration along an axis, no less than a machine's."""
        return float(max(np.sqrt(self._acceleration2), _LEAST_ACCELERATION_M_S2))

    @property
    def rate_rad_s(self) -> float:
        """Standard deviation of the angular velocity about an axis, no less than a machine's."""
        return float(max(np.sqrt(self._rate2), _LEAST_RATE_RAD_S))

    @property
    def step(self) -> tuple[float, float]:
        """Standard deviations of angular velocity [rad/s] and acceleration [m/s²] along an axis."""
        return self.rate_rad_s, self.acceleration_m_s2
