"""Whether the newest innovations of a sensor lean to one side."""

from collections import deque
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.gate.innovation_alarm import FALSE_ALARM_S, binary
from scipy.stats import beta, chi2

from executive.arrays import Float

_COUNT = 6


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
        self._degrees, self._period_s = degrees, 1.0
        self._white: deque[Float] = deque(maxlen=_COUNT)
        self._is_biased: bool | None = None  # None: not computed since the newest innovation

    def add(self, innovation: Float, covariance: Float, period_s: float) -> None:
        """Take an innovation.

        Args:
            innovation: Measured minus predicted, shape (m,).
            covariance: Its covariance by what is declared, shape (m, m).
            period_s: Usual time between two innovations [s]: the shorter, the rarer a false alarm
                has to be among them.
        """
        self._period_s, self._is_biased = period_s, None
        white = np.linalg.solve(np.linalg.cholesky(covariance), innovation)
        if np.isfinite(white).all():
            self._white.append(white)

    @property
    def is_biased(self) -> bool:
        """Whether the prediction is wrong; False until there are enough innovations."""
        if self._is_biased is None:
            self._is_biased = self._leans()
        return self._is_biased

    def _leans(self) -> bool:
        if len(self._white) < _COUNT:
            return False
        white = np.array(self._white)
        mean2 = _COUNT * float(np.square(white.mean(axis=0)).sum())
        far, one_sided = _limits(self._degrees, binary(self._period_s))
        return mean2 > max(far, one_sided * float(np.square(white).sum()))


@lru_cache(maxsize=64)
def _limits(degrees: int, period_s: float) -> tuple[float, float]:
    """Return bounds that chance exceeds once in `FALSE_ALARM_S`.

    The first is on the squared mean of white Gaussian innovations, times their number; the second
    on its share of the sum of their squares.
    """
    chance = period_s / FALSE_ALARM_S
    one_sided = beta.ppf(1 - chance, degrees / 2, degrees * (_COUNT - 1) / 2)
    return float(chi2.isf(chance, degrees)), float(one_sided)
