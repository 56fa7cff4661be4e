"""Whether the newest innovations of a sensor are larger than chance allows, over any few of them.

Source: the window-limited test of the mean of innovations, Willsky and Jones 1976 (generalised
likelihood ratio of a jump), with the time of the jump among the newest few.
"""

from collections import deque
from functools import lru_cache

import numpy as np
from scipy.stats import chi2

from executive.arrays import Float

WINDOW = 6  # innovations; means of the newest 1 to 6 are tested
_CALM = 3  # innovations that end an alarm
FALSE_ALARM_S = 3600.0  # mean time between two alarms of a sensor that errs as it declares
_USUAL = 0.95


class InnovationAlarm:
    """Raised by a mean of the newest innovations that their covariance does not explain.

    It tells that fixes and prediction contradict each other, not which of them is wrong. A jump
    shows in one innovation; a new bias of an inertial sensor in the mean of several that are each
    within their bounds.

    Attributes:
        is_raised: Whether there is an alarm. It ends when the mean of three innovations in a row
            is usual again.
    """

    def __init__(self, degrees: int) -> None:
        """Make one without innovations.

        Args:
            degrees: Length of an innovation.
        """
        self.is_raised = False
        self._degrees, self._since = degrees, 0
        self._white: deque[Float] = deque(maxlen=WINDOW)
        self._usual = float(chi2.ppf(_USUAL, degrees))

    def add(self, innovation: Float, covariance: Float, gate: float, period_s: float) -> None:
        """Take an innovation.

        Args:
            innovation: Measured minus predicted, shape (m,).
            covariance: Its covariance by what is known of the sensor, shape (m, m).
            gate: Largest squared Mahalanobis distance that counts. A single outlier is cut to it,
                so that it is no evidence of more than itself.
            period_s: Usual time between two innovations [s].
        """
        white = np.linalg.solve(np.linalg.cholesky(covariance), innovation)
        if not np.isfinite(white).all():
            return
        self._white.append(white * min(1.0, np.sqrt(gate) / max(np.linalg.norm(white), 1e-9)))
        newest = np.array(self._white)[::-1]
        counts = np.arange(1, len(newest) + 1)
        squares = np.square(np.cumsum(newest, axis=0)).sum(axis=1) / counts
        self._since += 1
        if squares.max() > _limit(self._degrees, binary(period_s)):
            self.is_raised, self._since = True, 0
        elif self._since >= _CALM and squares[_CALM - 1] < self._usual:
            self.is_raised = False


def binary(period_s: float) -> float:
    """Return the next smaller power of two: few limits are computed, and none is too low."""
    return float(2.0 ** np.floor(np.log2(np.clip(period_s, 1e-3, 60.0))))


@lru_cache(maxsize=64)
def _limit(degrees: int, period_s: float) -> float:
    """Return the bound on a squared mean that is exceeded by chance once in `FALSE_ALARM_S`."""
    return float(chi2.isf(period_s / (FALSE_ALARM_S * WINDOW), degrees))
