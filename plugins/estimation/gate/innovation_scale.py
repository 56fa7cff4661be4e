"""How much larger a sensor's errors are than it declares, by its newest innovations."""

import numpy as np
from executive_plugins.estimation.cholesky import whiten
from numba import njit, types

from executive.arrays import Float, Int
from executive.geometry import chi_square

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
SCALE_COUNT = 21  # innovations; their median is off by 30 % (one standard deviation)
_ENOUGH = 5
_STEPS, _EXACT = 20, 0.01  # of Newton's method, and the share of the median that may be left
LARGEST_SCALE = 25.0  # a sensor whose errors are more than five times the declared ones is wrong


class InnovationScale:
    """The factor on a declared covariance that explains the newest innovations.

    An innovation is the sum of the prediction's error and the sensor's, and the factor is on the
    sensor's alone: of each innovation, the factor with which its squared Mahalanobis distance is
    the median of its distribution is kept. The median of these decides, so that a few outliers do
    not count; a sensor that is more accurate than it declares is not trusted more, because errors
    that change slowly do not show in innovations.
    """

    def __init__(self, degrees: int, factor: float = 1.0) -> None:
        """Start with a factor that is known otherwise, or 1.

        Args:
            degrees: Length of an innovation.
            factor: The factor until there are enough innovations; they replace it one by one.
        """
        self._median = median_size(degrees)
        self._factors, self._counts = np.empty(SCALE_COUNT), np.zeros(2, np.int64)
        know_scale(self._factors, self._counts, factor)

    def factor(self) -> float:
        """Return the factor on the variance, from 1 to 25; 1 until there are enough innovations."""
        return float(middle_factor(self._factors, self._counts))

    def add(self, innovation: Float, predicted: Float, declared: Float) -> None:
        """Take an innovation.

        Args:
            innovation: Measured minus predicted, shape (m,).
            predicted: Covariance of the prediction, shape (m, m).
            declared: Covariance that the sensor declares, shape (m, m).
        """
        memory = self._factors, self._counts
        rescale(*memory, innovation, predicted, declared, self._median)


def know_scale(factors: Float, counts: Int, factor: float) -> None:
    """Fill the memory of a scale with a factor that is known otherwise, if it is more than 1."""
    factors[:] = factor
    counts[:] = SCALE_COUNT if factor > 1.0 else 0, 0


def median_size(degrees: int) -> float:
    """Return the median of an innovation's squared length in standard deviations."""
    return chi_square.median(degrees)


@njit(types.float64(types.float64[::1], types.int64[::1]), cache=True)  # type: ignore[untyped-decorator]
def middle_factor(factors: Float, counts: Int) -> float:
    """Return the median of the newest factors; 1 until there are enough; see `rescale`."""
    count = counts[0]
    if count < _ENOUGH:
        return 1.0
    rising, half = np.empty(count), count // 2
    for i in range(count):
        j = i
        while j > 0 and rising[j - 1] > factors[i]:
            rising[j] = rising[j - 1]
            j -= 1
        rising[j] = factors[i]
    return float(rising[half] if count % 2 else (rising[half - 1] + rising[half]) / 2)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _slope(L: Float, white: Float, declared: Float) -> float:
    """Return by how much the squared distance falls with the factor.

    Args:
        L: Cholesky factor of the covariance, shape (m, m).
        white: L⁻¹ innovation, shape (m,), replaced by the covariance's inverse times innovation.
        declared: Covariance that the sensor declares, shape (m, m).
    """
    m, slope = len(white), 0.0
    for i in range(m - 1, -1, -1):
        for j in range(i + 1, m):
            white[i] -= L[j, i] * white[j]
        white[i] /= L[i, i]
    for i in range(m):
        for j in range(m):
            slope += white[i] * declared[i, j] * white[j]
    return slope


@njit(cache=True)  # type: ignore[untyped-decorator]
def _explaining(innovation: Float, predicted: Float, declared: Float, middle: float) -> float:
    """Return the factor, from 1 to 25, with which an innovation is of median size.

    The distance falls with the factor, and is convex: Newton's steps from 1 do not overshoot.

    Args:
        innovation: Measured minus predicted, shape (m,).
        predicted: Covariance of the prediction, shape (m, m).
        declared: Covariance that the sensor declares, shape (m, m).
        middle: Median of the squared distance.

    Returns:
        The factor; NaN if a covariance is none, or a value is not finite.
    """
    m = len(innovation)
    S, L, white = np.empty((m, m)), np.empty((m, m)), np.empty(m)
    factor = 1.0
    for _ in range(_STEPS):
        for i in range(m):
            for j in range(m):
                S[i, j] = predicted[i, j] + factor * declared[i, j]
        excess = whiten(S, innovation, L, white) - middle
        if not np.isfinite(excess):
            return np.nan
        if excess <= _EXACT * middle:
            break
        slope = _slope(L, white, declared)
        if excess >= slope * (LARGEST_SCALE - factor):
            return LARGEST_SCALE
        factor += excess / slope
    return factor


@njit(  # type: ignore[untyped-decorator]
    types.void(*(types.float64[::1], types.int64[::1], _VECTOR, _MATRIX, _MATRIX, types.float64)),
    cache=True,
)
def rescale(
    factors: Float,
    counts: Int,
    innovation: Float,
    predicted: Float,
    declared: Float,
    middle: float,
) -> None:
    """Take an innovation into the memory of an `InnovationScale`.

    Args:
        factors: Of the newest innovations, shape (`SCALE_COUNT`,).
        counts: Number of factors in use, and the place of the next one, shape (2,).
        innovation: Measured minus predicted, shape (m,).
        predicted: Covariance of the prediction, shape (m, m).
        declared: Covariance that the sensor declares, shape (m, m).
        middle: Median of the squared distance, see `median_size`.
    """
    factor = _explaining(innovation, predicted, declared, middle)
    if np.isfinite(factor):
        factors[counts[1]] = factor
        counts[0] = min(counts[0] + 1, len(factors))
        counts[1] = (counts[1] + 1) % len(factors)
