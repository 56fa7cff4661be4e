"""Whether the newest innovations of a sensor lean to one side, and by how much."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.cholesky import whitened
from executive_plugins.estimation.gate.innovation_alarm import FALSE_ALARM_S, binary
from numba import njit, types

from executive.arrays import Float, Int
from executive.geometry import chi_square

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
# Numbers of innovations over which a lean is looked for. The mean of n of them is known √n times
# better than one, so that the longer ones show what a filter follows slowly.
_COUNTS = (6, 12, 24, 48)
BIAS_ROWS = _COUNTS[-1]  # innovations that are kept
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
        self._rows, self._counts = np.zeros((BIAS_ROWS, degrees)), np.zeros(2, np.int64)
        self._end, self._root = np.zeros(degrees), np.zeros((degrees, degrees))

    def add(self, innovation: Float, covariance: Float, period_s: float) -> None:
        """Take an innovation, and look for a lean.

        Args:
            innovation: Measured minus predicted, shape (m,).
            covariance: Its covariance by what is known, shape (m, m).
            period_s: Usual time between two innovations [s]: the shorter, the rarer a false alarm
                has to be among them.
        """
        found = whitened(covariance, innovation)
        if found is not None:
            white, self._root, _ = found
            limit = bias_limit(self._degrees, binary(period_s))
            look_for_lean(self._rows, self._counts, white, limit, self._end)

    def clear(self) -> None:
        """Forget all innovations: what they have shown is part of the prediction now."""
        self._counts[:] = 0

    @property
    def lean(self) -> Lean | None:
        """What the newest innovations show; None if they do not lean."""
        return lean_of(self._counts, self._root, self._end)

    @property
    def is_biased(self) -> bool:
        """Whether the prediction is wrong; False until there are enough innovations."""
        return bool(self._counts[1])


def lean_of(counts: Int, root: Float, end: Float) -> Lean | None:
    """Return what `look_for_lean` has found; None if there is no lean.

    Args:
        counts, end: Of `look_for_lean`.
        root: Cholesky factor of the newest innovation's covariance, shape (m, m).
    """
    lasts = int(counts[1])
    return Lean(root @ end, _share(lasts), lasts) if lasts else None


@njit(cache=True)  # type: ignore[untyped-decorator]
def _refutes_noise(far: float, all2: float, values: int, count: int) -> bool:
    """Return whether a line is far more likely than noise, by their squared sizes."""
    scale = max(all2 / values, 1.0)
    noise = -0.5 * (values * math.log(scale) + all2 / scale)
    line = -0.5 * (all2 - far + _ORDER * (values // count) * math.log(count))
    return bool(line - noise > _REFUTED)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _put_first(rows: Float, count: int, white: Float) -> None:
    """Put an innovation before the others, the last of which may be lost; see `_leaning`."""
    for i in range(count - 1, 0, -1):
        for j in range(len(white)):
            rows[i, j] = rows[i - 1, j]
    for j in range(len(white)):
        rows[0, j] = white[j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _leaning(rows: Float, count: int, white: Float, limit: float, end: Float) -> int:
    """Put an innovation first, and look for a lean in the fewest innovations that show one.

    Args:
        count: Number of rows that are in use with the new one.

    The others are those of `look_for_lean`.

    Returns:
        The number of innovations that show a lean; 0 if there is none.
    """
    m = len(white)
    _put_first(rows, count, white)
    total, moment, all2, begun = np.zeros(m), np.zeros(m), 0.0, 0
    for lasts in _COUNTS:
        if count < lasts:
            return 0
        for i in range(begun, lasts):
            for j in range(m):
                total[j] += rows[i, j]
                moment[j] += i * rows[i, j]
                all2 += rows[i, j] * rows[i, j]
        begun, middle, far = lasts, 0.5 * (lasts - 1), 0.0
        times2 = lasts * (lasts * lasts - 1) / 12.0
        for j in range(m):
            slope = middle * total[j] - moment[j]
            far += total[j] * total[j] / lasts + slope * slope / times2
        if far > limit and _refutes_noise(far, all2, m * lasts, lasts):
            for j in range(m):
                slope = middle * total[j] - moment[j]
                end[j] = total[j] / lasts + middle * slope / times2
            return lasts
    return 0


@njit(  # type: ignore[untyped-decorator]
    types.void(types.float64[:, ::1], types.int64[::1], _VECTOR, types.float64, types.float64[::1]),
    cache=True,
)
def look_for_lean(rows: Float, counts: Int, white: Float, limit: float, end: Float) -> None:
    """Take an innovation into the memory of an `InnovationBias`, and look for a lean.

    Args:
        rows: The newest innovations in standard deviations, newest first, shape (`BIAS_ROWS`, m).
        counts: Number of rows in use, and result: the number of innovations that show a lean, 0 if
            there is none, shape (2,).
        white: The new one, shape (m,).
        limit: Least squared size of a line, see `bias_limit`.
        end: Result, the line's value at the newest innovation, shape (m,).
    """
    counts[0] = min(counts[0] + 1, len(rows))
    counts[1] = _leaning(rows, counts[0], white, limit, end)


def _share(count: int) -> float:
    """Return the variance of a line's end, of that of one innovation."""
    return 1 / count + 3 * (count - 1) / (count * (count + 1))


@lru_cache(maxsize=64)
def bias_limit(degrees: int, period_s: float) -> float:
    """Return the bound on a line's squared size that chance exceeds once in `FALSE_ALARM_S`."""
    return chi_square.bound(period_s / (FALSE_ALARM_S * len(_COUNTS)), _ORDER * degrees)
