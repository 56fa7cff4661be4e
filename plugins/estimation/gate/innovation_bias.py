"""Whether the newest innovations of a sensor lean to one side, and by how much."""

from collections import deque
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.gate.innovation_alarm import FALSE_ALARM_S, binary
from scipy.stats import chi2

from executive.arrays import Float

# Numbers of innovations over which a lean is looked for. The mean of n of them is known √n times
# better than one, so that the longer ones show what a filter follows slowly.
_COUNTS = (6, 12, 24, 48)
_ORDER = 2  # a lean that is there and one that grows evenly
_REFUTED = 7.0  # noise is refuted if the innovations are e⁷ = 1,100 times less likely under it


@dataclass(frozen=True, slots=True, eq=False)
class Lean:
    """What innovations that lean say of the newest one.

    Attributes:
        innovation: The newest one without its noise, shape (m,).
        share: Of its variance in that of one innovation.
        lasts: Number of innovations that it was found in.
    """

    innovation: Float
    share: float
    lasts: int


class InnovationBias:
    """Tells a wrong prediction from noise that is larger than known.

    Innovations of a filter whose prediction is right are white, however noisy the sensor is
    (Kailath 1968). Two models of the newest ones compete: white noise of any size that is no less
    than known, and noise of the known size about a line over time, as a step of a bias gives (the
    generalised likelihood ratio of Willsky and Jones 1976, with the size of the model counted as
    by Schwarz 1978). Where the second is far more likely, the prediction is wrong: the inertial
    samples, a clock, or the state.
    """

    def __init__(self, degrees: int) -> None:
        """Make one without innovations.

        Args:
            degrees: Length of an innovation.
        """
        self._degrees = degrees
        self._white: deque[Float] = deque(maxlen=_COUNTS[-1])
        self._newest = np.eye(degrees)  # square root of the newest one's covariance
        self.lean: Lean | None = None

    def add(self, innovation: Float, covariance: Float, period_s: float) -> None:
        """Take an innovation, and look for a lean.

        Args:
            innovation: Measured minus predicted, shape (m,).
            covariance: Its covariance by what is known, shape (m, m).
            period_s: Usual time between two innovations [s]: the shorter, the rarer a false alarm
                has to be among them.
        """
        root = np.linalg.cholesky(covariance)
        white = np.linalg.solve(root, innovation)
        if np.isfinite(white).all():
            self._white.append(white)
            self._newest = np.asarray(root)
            self.lean = self._found(binary(period_s))

    def clear(self) -> None:
        """Forget all innovations: what they have shown is part of the prediction now."""
        self._white.clear()
        self.lean = None

    @property
    def is_biased(self) -> bool:
        """Whether the prediction is wrong; False until there are enough innovations."""
        return self.lean is not None

    def _found(self, period_s: float) -> Lean | None:
        """Return the lean of the fewest innovations that show one."""
        for count in _COUNTS:
            if len(self._white) < count:
                return None
            white = np.array(self._white)[-count:]
            line = _line(count)
            parts = line.T @ white
            far, all2 = float(np.square(parts).sum()), float(np.square(white).sum())
            if far > _limit(self._degrees, period_s) and self._refutes_noise(far, all2, count):
                end = self._newest @ (line[-1] @ parts)
                return Lean(np.asarray(end), float(line[-1] @ line[-1]), count)
        return None

    def _refutes_noise(self, far: float, all2: float, count: int) -> bool:
        """Return whether a line is far more likely than noise, by their squared sizes."""
        values = self._degrees * count
        scale = max(all2 / values, 1.0)
        noise = -0.5 * (values * np.log(scale) + all2 / scale)
        line = -0.5 * (all2 - far + _ORDER * self._degrees * np.log(count))
        return bool(line - noise > _REFUTED)


@lru_cache(maxsize=len(_COUNTS))
def _line(count: int) -> Float:
    """Return an orthonormal basis of lines over evenly spaced innovations, shape (n, 2)."""
    times = np.arange(count) - 0.5 * (count - 1)
    return np.column_stack(
        [np.full(count, count**-0.5), times / np.linalg.norm(times)],
    )


@lru_cache(maxsize=64)
def _limit(degrees: int, period_s: float) -> float:
    """Return the bound on a line's squared size that chance exceeds once in `FALSE_ALARM_S`."""
    return float(chi2.isf(period_s / (FALSE_ALARM_S * len(_COUNTS)), _ORDER * degrees))
