"""Hypotheses of which inertial sensor errs and by how much, weighed by the fixes.

Source: multiple-model estimation (Magill 1965), with hypotheses that differ in how the biases walk.
A bias that walks follows a step, a scale, a clipped axis and the end of each as well.
"""

from collections import deque
from collections.abc import Iterable

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.sensor_model import SensorModel

from executive.arrays import Float

# Sizes of a step as shares of the body's usual motion: a size that is wrong by the root of their
# ratio costs little likelihood.
_SHARES = (1.0, 1 / 4, 1 / 16)
_NOISIER = (1.0, 3.0**2, 10.0**2)  # factors on the fixes' variance, as far apart
_WITHIN_S = 1.0  # time in which a bias may walk by the size of its step
_FAR_LIKELIER = 7.0  # e⁷ = 1,100 times
_APART = 3.0  # e³ = 20 times, of one sensor over the other

FixToUse = tuple[float, Fix, float, float]
"""Time of the filter [s], the fix, the factor on its variance, and how late its stamp is [s]."""


class SensorBank:
    """Copies of a filter of before a doubt: with wrong rates, wrong forces, and noisier fixes.

    A filter that opens the biases of both sensors once its attitude errs takes one for the other:
    its linear model finds information about their difference that is not there. A copy of before
    has an attitude that is right, and one sensor to explain the fixes by.

    Attributes:
        adopted: The hypothesis that the filter follows; None at first.
    """

    def __init__(
        self,
        before: tuple[Block, int],
        fixes: Iterable[FixToUse],
        densities: Float,
        usual: tuple[float, float],
        doubted_s: float,
    ) -> None:
        """Begin at a filter of before the doubt.

        Args:
            before: The filter, shape (1,), dtype `FILTER`, and the number of the first inertial
                sample that is newer than its state.
            fixes: Those since then.
            densities: Noise of sound sensors, see `InertialNoise`, shape (4,).
            usual: Usual angular velocity [rad/s] and acceleration [m/s²], see `UsualMotion`.
            doubted_s: Time of the first fix in doubt [s].
        """
        self._waiting, self._doubted_s = deque(fixes), doubted_s
        self._models = [SensorModel("", before, densities, scale) for scale in _NOISIER]
        for place, sensor, size in zip((2, 3), ("rates", "forces"), usual, strict=True):
            for share in _SHARES:
                walking = np.array(densities)
                walking[place] = max(densities[place], share * size * _WITHIN_S**-0.5)
                self._models.append(SensorModel(sensor, before, walking))
        self._enough: int | None = None  # fixes after which one may be adopted
        self.adopted: SensorModel | None = None

    @property
    def first(self) -> int:
        """Number of the first inertial sample that is newer than its states."""
        return self._models[0].first

    @property
    def is_refuted(self) -> bool:
        """Whether fixes contradict all hypotheses of a wrong sensor."""
        return not any(one.is_consistent for one in self._models if one.sensor)

    def add_fix(self, fix: FixToUse) -> None:
        """Add a fix that is used when the hypotheses are predicted to its time."""
        self._waiting.append(fix)

    def follow(self, ring: Block, end: int, now_s: float, last: Fix | None = None) -> None:
        """Propagate to a time, and use the fixes on the way.

        Args:
            ring, end: See `packed_prediction.predict_until`.
            now_s: The time [s].
            last: The last fix that is used; None for all up to the time.
        """
        used = None
        while self._waiting and self._waiting[0][0] <= now_s and (last is None or used is not last):
            stamp_s, used, scale, late_s = self._waiting.popleft()
            if stamp_s < self._models[0].stamp_s:
                continue  # it came too late for the filter as well
            for model in self._models:
                model.predict_until(ring, end, stamp_s)
                model.use(used, scale, late_s, stamp_s >= self._doubted_s)
        for model in self._models:
            model.predict_until(ring, end, now_s)

    def weigh(self, by_filter: float, agreeing: int) -> None:
        """Take a fix in doubt, the one that was used last.

        Args:
            by_filter: Logarithm of its likelihood by the filter, see `log_likelihood`.
            agreeing: Number of fixes from the first one in doubt on that are needed.
        """
        for model in self._models:
            model.weigh(by_filter)
        if self._enough is None:
            self._enough = self._models[0].count + agreeing - 1

    def choice(self, widest_rad: float) -> SensorModel | None:
        """Return the hypothesis that the filter should follow; None if none is decided for.

        The first one must be far likelier than sound sensors and than the filter, and likelier
        than what is the best of the other sensor. Another must be far likelier than the adopted.

        Args:
            widest_rad: Largest standard deviation of its attitude: its model is linear [rad].
        """
        if self._enough is None or self._models[0].count < self._enough:
            return None
        best, adopted = max(self._models, key=_likelihood), self.adopted
        if adopted is None:
            if not self._is_decided(best):
                return None
        elif not (_is_usable(best, widest_rad) and _leads(best, adopted, _FAR_LIKELIER)):
            best = adopted
        return best if _is_usable(best, widest_rad) else None

    def _is_decided(self, best: SensorModel) -> bool:
        """Return whether the likeliest hypothesis is so likely that it may be the first."""
        if not (best.sensor and best.gain > _FAR_LIKELIER):
            return False
        return all(
            _leads(best, one, _APART if one.sensor else _FAR_LIKELIER)
            for one in self._models
            if one.sensor != best.sensor
        )


def _likelihood(model: SensorModel) -> float:
    return model.log_likelihood


def _leads(one: SensorModel, other: SensorModel, by: float) -> bool:
    return one.log_likelihood > other.log_likelihood + by


def _is_usable(model: SensorModel, widest_rad: float) -> bool:
    """Return whether fixes agree with a hypothesis, and its attitude is known well enough."""
    return model.is_consistent and model.attitude_std_rad < widest_rad
