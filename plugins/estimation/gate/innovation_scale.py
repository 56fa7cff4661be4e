"""How much larger a sensor's errors are than it declares, by its newest innovations."""

from collections import deque
from statistics import median

import numpy as np
from scipy.stats import chi2

from executive.arrays import Float

_COUNT = 21  # innovations; their median is off by 30 % (one standard deviation)
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
        self._median = float(chi2.median(degrees))
        known = [factor] * (_COUNT if factor > 1.0 else 0)
        self._factors: deque[float] = deque(known, maxlen=_COUNT)

    def factor(self) -> float:
        """Return the factor on the variance, from 1 to 25; 1 until there are enough innovations."""
        return median(self._factors) if len(self._factors) >= _ENOUGH else 1.0

    def add(self, innovation: Float, predicted: Float, declared: Float) -> None:
        """Take an innovation.

        Args:
            innovation: Measured minus predicted, shape (m,).
            predicted: Covariance of the prediction, shape (m, m).
            declared: Covariance that the sensor declares, shape (m, m).
        """
        S = predicted + declared
        try:
            L = np.asarray(np.linalg.cholesky(S), dtype=np.float64)
        except np.linalg.LinAlgError:  # a covariance that is none says nothing
            return
        white = np.asarray(np.linalg.solve(L, innovation), dtype=np.float64)
        if np.isfinite(white).all():
            self._factors.append(self._explaining(white, L, declared))

    def _explaining(self, white: Float, L: Float, declared: Float) -> float:
        """Return the factor, from 1 to 25, with which an innovation is of median size.

        The distance falls with the factor, and is convex: Newton's steps from 1 do not overshoot.

        Args:
            white: The innovation in standard deviations by the factor 1, shape (m,).
            L: Cholesky factor of its covariance by that, shape (m, m).
            declared: Covariance that the sensor declares, shape (m, m).
        """
        if float(white @ white) <= self._median:
            return 1.0
        W = np.linalg.solve(L, np.linalg.solve(L, declared).T)
        shares, axes = np.linalg.eigh(0.5 * (W + W.T))
        shares, squares = np.maximum(shares, 0.0), (axes.T @ white) ** 2
        factor = 1.0
        for _ in range(_STEPS):
            variances = 1.0 + (factor - 1.0) * shares
            excess = float((squares / variances).sum()) - self._median
            if excess <= _EXACT * self._median:
                break
            slope = float((squares * shares / variances**2).sum())
            if excess >= slope * (LARGEST_SCALE - factor):
                return LARGEST_SCALE
            factor += excess / slope
        return factor
