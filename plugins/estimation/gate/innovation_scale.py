"""How much larger a sensor's errors are than it declares, by its newest innovations."""

from collections import deque
from statistics import median

import numpy as np
from scipy.stats import chi2

from executive.arrays import Float

_COUNT = 21  # innovations; their median is off by 30 % (one standard deviation)
_ENOUGH = 5
LARGEST_SCALE = 25.0  # a sensor whose errors are more than five times the declared ones is wrong


class InnovationScale:
    """The factor on a declared covariance that explains the newest innovations.

    The median decides, so that a few outliers do not count; a sensor that is more accurate than it
    declares is not trusted more, because errors that change slowly do not show in innovations.
    """

    def __init__(self, degrees: int, factor: float = 1.0) -> None:
        """Start with a factor that is known otherwise, or 1.

        Args:
            degrees: Length of an innovation.
            factor: The factor until there are enough innovations; they replace it one by one.
        """
        self._median = float(chi2.median(degrees))
        known = [factor * self._median] * (_COUNT if factor > 1.0 else 0)
        self._squares: deque[float] = deque(known, maxlen=_COUNT)

    def factor(self) -> float:
        """Return the factor on the variance, from 1 to 25; 1 until there are enough innovations."""
        if len(self._squares) < _ENOUGH:
            return 1.0
        return min(max(median(self._squares) / self._median, 1.0), LARGEST_SCALE)

    def add(self, innovation: Float, predicted: Float, declared: Float) -> None:
        """Take an innovation.

        Args:
            innovation: Measured minus predicted, shape (m,).
            predicted: Covariance of the prediction, shape (m, m).
            declared: Covariance that the sensor declares, shape (m, m).
        """
        square = float(innovation @ np.linalg.solve(predicted + declared, innovation))
        if np.isfinite(square):
            self._squares.append(square)
