"""Whether the newest innovations of a sensor are larger than chance allows, over any few of them.

Source: the window-limited test of the mean of innovations, Willsky and Jones 1976 (generalised
likelihood ratio of a jump), with the time of the jump among the newest few.
"""

import math
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.cholesky import whitened
from numba import njit, types

from executive.arrays import Float, Int
from executive.geometry import chi_square

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
    """

    def __init__(self, degrees: int) -> None:
        """Make one without innovations.

        Args:
            degrees: Length of an innovation.
        """
        self._degrees, self._usual = degrees, usual_size(degrees)
        self._rows, self._counts = np.zeros((WINDOW, degrees)), np.zeros(3, np.int64)

    @property
    def is_raised(self) -> bool:
        """Whether there is an alarm.

        It ends when the mean of three innovations in a row is usual again.
        """
        return bool(self._counts[2])

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
        if found is not None:
            bounds = gate, alarm_limit(self._degrees, binary(period_s)), self._usual
            alert(self._rows, self._counts, found[0], found[2], *bounds)


@njit(cache=True)  # type: ignore[untyped-decorator]
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


@njit(  # type: ignore[untyped-decorator]
    types.void(types.float64[:, ::1], types.int64[::1], _VECTOR, *[types.float64] * 4), cache=True
)
def alert(
    rows: Float,
    counts: Int,
    white: Float,
    distance2: float,
    gate: float,
    limit: float,
    usual: float,
) -> None:
    """Take an innovation into the memory of an alarm.

    Args:
        rows: The newest innovations in standard deviations, newest first, shape (`WINDOW`, m).
        counts: Number of rows in use, number of innovations since the alarm was raised last, and
            whether it is raised, shape (3,).
        white: The innovation in standard deviations, shape (m,).
        distance2: Its squared length.
        gate: Largest squared length that counts.
        limit: Bound on a squared mean, see `alarm_limit`.
        usual: Squared mean below which an alarm ends, see `usual_size`.
    """
    counts[0] = min(counts[0] + 1, len(rows))
    cut = min(1.0, math.sqrt(gate) / max(math.sqrt(distance2), 1e-9))
    largest, newest = _means(rows, counts[0], white, cut)
    counts[1] += 1
    if largest > limit:
        counts[1], counts[2] = 0, 1
    elif counts[1] >= _CALM and newest < usual:
        counts[2] = 0


def usual_size(degrees: int) -> float:
    """Return the squared length in standard deviations below which an innovation is usual."""
    return chi_square.quantile(_USUAL, degrees)


def binary(period_s: float) -> float:
    """Return the next smaller power of two: few limits are computed, and none is too low."""
    return float(2.0 ** math.floor(math.log2(min(max(period_s, 1e-3), 60.0))))


@lru_cache(maxsize=64)
def alarm_limit(degrees: int, period_s: float) -> float:
    """Return the bound on a squared mean that is exceeded by chance once in `FALSE_ALARM_S`."""
    return chi_square.bound(period_s / (FALSE_ALARM_S * WINDOW), degrees)


@lru_cache(maxsize=64)
def chance_limit(period_s: float) -> float:
    """Return the bound on the squared length of three deviations that chance exceeds once in
    `FALSE_ALARM_S`, if they are looked at once in a period [s].
    """
    return chi_square.bound(period_s / FALSE_ALARM_S, 3)
