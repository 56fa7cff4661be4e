"""A copy of a filter under the hypothesis that an inertial sensor errs, held against fixes."""

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.state import ROTATION
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_likelihood import log_likelihood, scaled_distance2
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_measurements import correct_by_compared
from executive_plugins.estimation.kalman.packed_prediction import predict_until

from executive.arrays import Float
from executive.geometry import chi_square

# Probability of larger innovations of a model that is right. It is small, as the sum is looked at
# after each fix.
_UNLIKELY = 1e-3
_predict_until, _correct_by_compared = direct(predict_until), direct(correct_by_compared)


class SensorModel:
    """A filter with noise of its own, which begins before a doubt and uses all fixes since.

    Attributes:
        words: What errs.
        sensor: The inertial sensor that errs: `rates` or `forces`; empty if none does.
        first: Number of the first inertial sample that is newer than its state.
        log_likelihood: Of all fixes so far, but for a constant.
        gain: By how much the fixes in doubt are likelier than by the filter, as a logarithm.
        count: Number of fixes so far.
    """

    def __init__(
        self, sensor: str, before: tuple[Block, int], densities: Float, scale: float = 1.0
    ) -> None:
        """Copy a filter.

        Args:
            sensor: The inertial sensor that errs; empty if none does.
            before: The filter, shape (1,), dtype `FILTER`, and the number of the first inertial
                sample that is newer than its state.
            densities: Of the noise under this hypothesis, see `InertialNoise`, shape (4,).
            scale: Factor on the variance of fixes since the doubt.
        """
        block, self.first = before
        self.sensor, self._scale = sensor, scale
        self.words = f"wrong {sensor} of the inertial sensor" if sensor else "noise of the fixes"
        self._block: Block = block.copy()
        self._block["densities"][0], self._block["holds_clock"] = densities, 1
        self.log_likelihood = self.gain = self._newest = self._distance2 = 0.0
        self.count = 0

    @property
    def stamp_s(self) -> float:
        """Time of its state [s]."""
        return float(self._block["sample"]["stamp_s"].item())

    @property
    def is_consistent(self) -> bool:
        """Whether its innovations are no larger than chance makes of them."""
        return self._distance2 <= chi_square.bound(_UNLIKELY, 3 * max(self.count, 1))

    @property
    def attitude_std_rad(self) -> float:
        """Standard deviation of the attitude about its worst axis [rad]."""
        return attitude_std_rad(self._block)

    def predict_until(self, ring: Block, end: int, until_s: float) -> None:
        """Propagate through samples up to a time; see `packed_prediction.predict_until`."""
        self.first = int(_predict_until(self._block, ring, self.first, end, until_s))

    def use(self, fix: Fix, scale: float, late_s: float, is_doubted: bool) -> None:
        """Correct by a fix at the time of its state, of before the doubt or since.

        See `fix_likelihood.scaled_distance2` for the other arguments.
        """
        if is_doubted:
            scale *= self._scale
        self._distance2 += scaled_distance2(self._block, fix, scale, late_s)
        self._newest = log_likelihood(self._block)
        self.log_likelihood += self._newest
        self.count += 1
        _correct_by_compared(self._block, float("inf"))

    def weigh(self, by_filter: float) -> None:
        """Take the logarithm of the likelihood by the filter of the fix that was used last."""
        self.gain += self._newest - by_filter

    def replace(self, kalman: ErrorStateFilter) -> None:
        """Let a filter of the same time be as this one."""
        kalman.block[:] = self._block
        kalman.forget_object()


def attitude_std_rad(block: Block) -> float:
    """Return the standard deviation of a filter's attitude about its worst axis [rad]."""
    return float(np.sqrt(np.linalg.eigvalsh(block["P"][0, ROTATION, ROTATION])[-1]))
