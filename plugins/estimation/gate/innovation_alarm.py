"""Whether the newest innovations of a sensor are larger than chance allows, over any few of them.

Source: the window-limited test of the mean of innovations, Willsky and Jones 1976 (generalised
likelihood ratio of a jump), with the time of the jump among the newest few.
"""

import math
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.cholesky import whitened
from numba import njit, types
from scipy.stats import chi2

from executive.arrays import Float

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
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
        self._white = np.zeros((WINDOW, degrees))  # in standard deviations, newest first
        self._count = 0
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
        found = whitened(covariance, innovation)
        if found is None:
            return
        white, _, distance2 = found
        self._count = min(self._count + 1, WINDOW)
        cut = min(1.0, math.sqrt(gate) / max(math.sqrt(distance2), 1e-9))
        largest, newest = _means(self._white, self._count, white, cut)
        self._since += 1
        if largest > _limit(self._degrees, binary(period_s)):
            self.is_raised, self._since = True, 0
        elif self._since >= _CALM and newest < self._usual:
            self.is_raised = False


@njit(  # type: ignore[untyped-decorator]
    types.UniTuple(types.float64, 2)(types.float64[:, ::1], types.int64, _VECTOR, types.float64),
    cache=True,
)
def _means(rows: Float, count: int, white: Float, cut: float) -> tuple[float, float]:
    """Put an innovation first; return how large the means of the newest ones are.

    Args:
        rows: The innovations in standard deviations, newest first, shape (n, m).
        count: Number of rows that are in use with the new one.
        white: The new one, shape (m,).
        cut: Factor on it.

    Returns:
        The largest squared mean over the newest 1, 2, … in its own variance, and that over the
        newest `_CALM` (0 if there are fewer).
    """
    m = len(white)
    for i in range(count - 1, 0, -1):
        for j in range(m):
            rows[i, j] = rows[i - 1, j]
    for j in range(m):
        rows[0, j] = cut * white[j]
    largest, newest = 0.0, 0.0
    total = np.zeros(m)
    for i in range(count):
        square = 0.0
        for j in range(m):
            total[j] += rows[i, j]
            square += total[j] * total[j]
        square /= i + 1
        largest = max(largest, square)
        if i + 1 == _CALM:
            newest = square
    return largest, newest


def binary(period_s: float) -> float:
    """Return the next smaller power of two: few limits are computed, and none is too low."""
    return float(2.0 ** math.floor(math.log2(min(max(period_s, 1e-3), 60.0))))


@lru_cache(maxsize=64)
def _limit(degrees: int, period_s: float) -> float:
    """Return the bound on a squared mean that is exceeded by chance once in `FALSE_ALARM_S`."""
    return float(chi2.isf(period_s / (FALSE_ALARM_S * WINDOW), degrees))
