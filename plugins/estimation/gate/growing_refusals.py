"""Whether refused fixes show that the prediction runs away from them, not they from it."""

import numpy as np

from executive.arrays import Float
from executive.geometry import chi_square

_ENOUGH, _MOST = 3, 500  # refusals
# Cosine between refusals that point to one side: of three random directions, one triple in 100.
_SAME_SIDE = 0.8
# Growth from the first to the newest. An acceleration that began up to two periods before the
# first refusal gives (4 / 2)² = 4 at the third; fixes that have jumped are off by the same again.
_GROWN = 3.0
_FALSE_ALARM = 1e-4
_LEAST_M = 1e-3  # no receiver is more accurate, whatever it declares


class GrowingRefusals:
    """The innovations of fixes that were refused since one was used.

    Fixes that have jumped, by another solution or a reflection, are off by the same vector again
    and again. A prediction that is wrong, by an inertial sensor that errs more than it declares,
    leaves them faster and faster to one side: then the fixes are used, for their error is
    bounded and the prediction's is not.
    """

    def __init__(self) -> None:
        self._innovations: list[Float] = []
        self._bound = chi_square.bound(_FALSE_ALARM, 3)

    def clear(self) -> None:
        """Forget all, since a fix was used."""
        self._innovations.clear()

    def is_running_away(self, innovation: Float, noise: Float) -> bool:
        """Take a refused fix; return whether the prediction runs away from it.

        Some earlier, a middle and the newest innovation must point to one side and grow, and their
        second difference must be more than the noise of three fixes explains: fixes that drift
        evenly show no acceleration. The earliest is the first or, as that may be of fixes that
        have come back from a jump, the one in the middle.

        Args:
            innovation: Measured minus predicted, map axes [m], shape (3,).
            noise: Covariance of the fix [m²], shape (3, 3).
        """
        if len(self._innovations) < _MOST:
            self._innovations.append(innovation)
        count = len(self._innovations)
        if count < _ENOUGH:
            return False
        last = count - 1 - (count + 1) % 2  # so that the middle one is as far from both
        return self._grow(last, last // 2, noise) or self._grow(last, last // 4, noise)

    def _grow(self, last: int, step: int, noise: Float) -> bool:
        """Return whether three innovations, evenly spaced up to one, grow to one side."""
        if step == 0:
            return False
        chosen = [self._innovations[i] for i in (last - 2 * step, last - step, last)]
        sizes = [max(float(np.linalg.norm(one)), 1e-9) for one in chosen]
        newest = chosen[-1] / sizes[-1]
        is_aside = all(
            float(one @ newest) > _SAME_SIDE * size for one, size in zip(chosen, sizes, strict=True)
        )
        bend = chosen[0] - 2 * chosen[1] + chosen[2]
        variance = 6.0 * (noise + _LEAST_M**2 * np.eye(3))  # of the bend: 1 + 4 + 1
        bend2 = float(bend @ np.linalg.solve(variance, bend))
        return is_aside and sizes[-1] > _GROWN * sizes[0] and bend2 > self._bound
