"""Whether the newest innovations of a sensor lean to one side."""

from collections import deque

import numpy as np
from scipy.stats import beta, chi2

from executive.arrays import Float

_COUNT = 6
_FALSE_ALARM = 1e-4


class InnovationBias:
    """Tells a wrong prediction from noise that is larger than declared.

    Innovations of a filter whose prediction is right are white, however noisy the sensor is
    (Kailath 1968). If the newest ones lean to one side, and by more than the declared covariance
    explains, the prediction is wrong: the inertial samples, a clock, or the state.
    """

    def __init__(self, degrees: int) -> None:
        """Make one without innovations.

        Args:
            degrees: Length of an innovation.
        """
        self._white: deque[Float] = deque(maxlen=_COUNT)
        self._far = float(chi2.ppf(1 - _FALSE_ALARM, degrees))
        # Of white Gaussian innovations, the share of their squares that is that of their mean.
        self._one_sided = float(beta.ppf(1 - _FALSE_ALARM, degrees / 2, degrees * (_COUNT - 1) / 2))

    def add(self, innovation: Float, covariance: Float) -> None:
        """Take an innovation, shape (m,), and its covariance by what is declared, shape (m, m)."""
        white = np.linalg.solve(np.linalg.cholesky(covariance), innovation)
        if np.isfinite(white).all():
            self._white.append(white)

    @property
    def is_biased(self) -> bool:
        """Whether the prediction is wrong; False until there are enough innovations."""
        if len(self._white) < _COUNT:
            return False
        white = np.array(self._white)
        mean2 = _COUNT * float(np.square(white.mean(axis=0)).sum())
        return mean2 > max(self._far, self._one_sided * float(np.square(white).sum()))
