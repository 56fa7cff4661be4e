"""Fixes as witnesses: what the newest innovations say of the error of a state.

A filter that refuses fixes, or follows them more slowly than they move, is right or wrong, and its
covariance does not tell which. Where both contradict each other, a reported covariance holds both.
"""

from collections import deque
from collections.abc import Iterator

import numpy as np
from executive_plugins.estimation.cholesky import whitened
from executive_plugins.estimation.gate.likely_error import likely_error

from executive.arrays import Float

# Numbers of innovations whose means are looked at: those of an alarm and of a lean.
_COUNTS = np.array([2, 3, 4, 5, 6, 12, 24, 48])
_NOTHING = np.zeros((3, 3))


class FixWitness:
    """The largest error of a state that its newest fixes make likely.

    A fix that is refused counts until some later ones agree with the state. One that is used has
    moved the state, which may be as wrong from then on.

    Attributes:
        moved2: Second moment of the position's error, map axes [m²], shape (3, 3); None while
            chance explains what differs.
    """

    def __init__(self, held: int, kept_s: float) -> None:
        """Begin without fixes.

        Args:
            held: Number of fixes for which one counts that was refused.
            kept_s: Time for which one that was used counts [s].
        """
        self._kept_s = kept_s
        self._newest: deque[Float] = deque(maxlen=held)
        # Times and moments of those that were used and that no later one exceeds.
        self._used: deque[tuple[float, Float]] = deque()
        self.moved2: Float | None = None

    def clear(self) -> None:
        """Forget all fixes, as the state is another one."""
        self._newest.clear()
        self._used.clear()
        self.moved2 = None

    def begin(self, other: "FixWitness") -> None:
        """Begin with the fixes that another one has taken, from which the state was found."""
        self.clear()
        self._used.extend(other._used)
        self._choose()

    def take(self, innovation: Float, covariance: Float, white: Float, period_s: float) -> None:
        """Take a fix.

        Args:
            innovation: Measured minus predicted [m], shape (3,).
            covariance: Of it [m²], shape (3, 3).
            white: Innovations of the same antenna in standard deviations, without outliers, the
                newest first, shape (n, 3).
            period_s: Usual time between two fixes of it [s].
        """
        found = whitened(covariance, innovation)
        if found is None:
            return
        moments = [likely_error(innovation, covariance, period_s)]
        for count, mean in _unusual_means(white):
            of_mean = covariance / count
            moments.append(likely_error(found[1] @ mean, of_mean, count * period_s))
        self._newest.append(max(moments, key=np.trace))
        self._choose()

    def use(self, now_s: float) -> None:
        """Take that the state was corrected by the fix that was taken last [s]."""
        used = self._used
        while used and now_s - used[0][0] > self._kept_s:
            used.popleft()
        if self._newest and self._newest[-1].any():
            size2 = np.trace(self._newest[-1])
            while used and np.trace(used[-1][1]) <= size2:
                used.pop()
            used.append((now_s, self._newest[-1]))
        self._choose()

    def use_sound(self, count: int, now_s: float) -> None:
        """Take a number of fixes that do not contradict the state, the last at a time [s]."""
        if self.moved2 is not None:
            self._newest.extend(_NOTHING for _ in range(count))
            self.use(now_s)

    def _choose(self) -> None:
        """Find the largest moment that counts."""
        used = [self._used[0][1]] if self._used else []
        largest = max([_NOTHING, *self._newest, *used], key=np.trace)
        self.moved2 = largest if largest.any() else None


def _unusual_means(white: Float) -> Iterator[tuple[int, Float]]:
    """Yield numbers of the newest innovations, and their means that are larger than on average."""
    counts = _COUNTS[len(white) >= _COUNTS]
    sums = np.cumsum(white, axis=0)[counts - 1]
    for count, total in zip(counts.tolist(), sums, strict=True):
        if total @ total > count * len(total):
            yield count, total / count
