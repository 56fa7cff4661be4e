"""A copy of a filter of before a doubt, which inertial samples alone have predicted since."""

from collections import deque
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.innovation_alarm import binary, chance_limit
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    GYRO_BIAS,
    ROTATION,
    VELOCITY,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_likelihood import (
    innovation_covariance,
    log_likelihood,
    scaled_distance2,
)
from executive_plugins.estimation.kalman.gradual_correction import correct_gradually
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_prediction import predict_until

from executive.arrays import Float
from executive.geometry import chi_square
from executive.geometry.rotation import skew

_LEFT_OUT = 0.01  # probability of a sound fix that counts as one that disagrees
# Probability of a sound fix that is refuted by far. It is a hundredth of the one above, so that no
# noise makes a fix agree after one that was refuted at the limit.
_FAR = 1e-4
_predict_until = direct(predict_until)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """The innovation of a fix: its time [s], value (3,), and the noise in it (3, 3)."""

    stamp_s: float
    innovation: Float
    noise: Float


class PredictedCopy:
    """Where a filter would be if no fix had been used since they began to be in doubt.

    Fixes that are wrong draw a filter along, or make it open its biases to explain them; when they
    are sound again, it refuses those, and takes seconds to return. The copy knows as much as
    inertial samples alone tell. It refutes wrong fixes and agrees with the sound ones after them:
    several in a row, each of which corrects a trial state that the next one is held against.

    They must be more likely by the copy than by the filter, whose state is known better if it is
    right.

    The copy becomes uncertain with time, and agrees with anything in the end. Agreement counts only
    if fixes have come back: the newest one that was refuted would be refuted now by far, or the
    fixes have moved by a step that the body has not made.

    Attributes:
        since_s: Time of the filter at which it was made [s].
    """

    def __init__(self, kalman: ErrorStateFilter, first: int) -> None:
        """Copy a filter that the fix in doubt has not corrected.

        Args:
            kalman: The filter.
            first: Number of the first inertial sample that is newer than its state.
        """
        self.since_s = kalman.stamp_s
        self._block: Block = kalman.block.copy()
        self._trial: Block | None = None
        self._first, self._agreed = first, 0
        self._gain = 0.0  # of the fixes that agree: by how much more likely the copy makes them
        self._waiting: deque[tuple[float, Fix, float, float]] = deque()
        self._seen: dict[str, tuple[_Seen, ...]] = {}  # the newest two of each antenna
        self._refuted: Float | None = None  # innovation of the newest fix that was refuted
        self._is_back = False  # whether fixes agree again after one that was refuted

    @property
    def stamp_s(self) -> float:
        """Time of its state [s]."""
        return float(self._block["sample"]["stamp_s"].item())

    def add_fix(self, fix: Fix, scale: float, late_s: float) -> None:
        """Add a fix that it is held against when it is predicted to its time.

        Args:
            fix: The fix.
            scale: Factor on its variance as it was known before the doubt.
            late_s: By how much its stamp is thought to be late [s].
        """
        self._waiting.append((fix.stamp_s - late_s, fix, scale, late_s))

    def predict_until(self, ring: Block, end: int, until_s: float) -> None:
        """Propagate through samples up to a time, and look at the fixes on the way.

        Args:
            ring, end: See `packed_prediction.predict_until`.
            until_s: The time [s].
        """
        while self._waiting and self._waiting[0][0] <= until_s:
            stamp_s, fix, scale, late_s = self._waiting.popleft()
            if stamp_s >= self.stamp_s:
                self._propagate(ring, end, stamp_s)
                self._look_at(fix, scale, late_s)
        self._propagate(ring, end, until_s)

    def _propagate(self, ring: Block, end: int, until_s: float) -> None:
        first = self._first
        self._first = int(_predict_until(self._block, ring, first, end, until_s))
        if self._trial is not None:
            _predict_until(self._trial, ring, first, end, until_s)

    def _look_at(self, fix: Fix, scale: float, late_s: float) -> None:
        """Hold the copy against a fix."""
        distance2 = scaled_distance2(self._block, fix, scale, late_s)
        seen = _Seen(self.stamp_s, *_innovation(self._block))
        before = self._seen.get(fix.antenna, ())
        self._seen[fix.antenna] = (*before[-1:], seen)
        if distance2 > agreement_limit():
            self._refuted, self._is_back = seen.innovation, False
        elif self._refuted is not None and not self._is_back:
            refuted2 = squared_distance(innovation_covariance(self._block), self._refuted)
            self._is_back = refuted2 > far_limit() or self._is_step(before, seen)

    def _is_step(self, before: tuple[_Seen, ...], now: _Seen) -> bool:
        """Return whether fixes have moved by what neither noise nor the copy's drift explains.

        Two fixes before tell the drift: what the copy's velocity errs is the same in both spans.
        """
        if not before:
            return False
        newest, since_s = before[-1], now.stamp_s - before[-1].stamp_s
        step, noise = now.innovation - newest.innovation, now.noise + newest.noise
        before_s = newest.stamp_s - before[0].stamp_s
        if before_s > 0.0:
            ratio = since_s / before_s
            step = step - ratio * (newest.innovation - before[0].innovation)
            noise = now.noise + (1.0 + ratio) ** 2 * newest.noise + ratio**2 * before[0].noise
            drift = self._bend(since_s, before_s)
        else:
            R = since_s * self._block[0]["R"]
            drift = R @ self._block[0]["P"][VELOCITY, VELOCITY] @ R.T
        return squared_distance(noise + drift, step) > chance_limit(binary(since_s))

    def _bend(self, since_s: float, before_s: float) -> Float:
        """Return the covariance of how far the copy's acceleration bends its way over two spans.

        The acceleration errs by the attitude, which turns by the gyroscope's bias meanwhile, and by
        the accelerometer's bias [m²], shape (3, 3).
        """
        row, time2_s2 = self._block[0], 0.5 * since_s * (since_s + before_s)
        P, R = row["P"], row["R"]
        pull = R @ skew(row["sample"]["force"] - row["accel_bias"])
        turned = P[ROTATION, ROTATION] + (since_s + before_s) ** 2 * P[GYRO_BIAS, GYRO_BIAS]
        acceleration = pull @ turned @ pull.T + R @ P[ACCEL_BIAS, ACCEL_BIAS] @ R.T
        return np.asarray(time2_s2**2 * acceleration)

    def take(self, kalman: ErrorStateFilter, fix: Fix, scale: float, late_s: float) -> int:
        """Compare with a fix that is in doubt for the filter, at the time of both.

        Args:
            kalman: The filter, which was compared with the fix and was not corrected by it.
            fix, scale, late_s: See `add_fix`.

        Returns:
            The number of fixes in a row, this one included, that agree with the copy; 0 while they
            are more likely by the filter.
        """
        trial = self._trial
        if trial is not None and scaled_distance2(trial, fix, scale, late_s) > agreement_limit():
            self.disagree()
        if self._trial is None:
            distance2 = scaled_distance2(self._block, fix, scale, late_s)
            if distance2 > agreement_limit() or not self._is_back:
                return 0
            self._trial = self._block.copy()
            self._trial["holds_clock"] = 1
        noise = self._trial["noise"][0, :9]
        self._gain += log_likelihood(self._trial, noise) - log_likelihood(kalman.block, noise)
        correct_gradually(self._trial, fix, scale, late_s)
        self._agreed += 1
        return self._agreed if self._gain > 0.0 else 0

    def disagree(self) -> None:
        """Forget the fixes that agree: the newest one is as good with the filter."""
        self._trial, self._agreed, self._gain = None, 0, 0.0

    def replace(self, kalman: ErrorStateFilter) -> None:
        """Let a filter be as the copy is with the fixes that agree with it."""
        if self._trial is not None:
            kalman.block[:] = self._trial
            kalman.forget_object()


def _innovation(block: Block) -> tuple[Float, Float]:
    """Return the innovation that was compared last, shape (3,), and its noise, shape (3, 3)."""
    row = block[0]
    return row["residual"][:3].copy(), row["noise"][:9].reshape(3, 3).copy()


@lru_cache(maxsize=1)
def agreement_limit() -> float:
    """Return the squared distance that 99 of 100 sound fixes are within."""
    return chi_square.bound(_LEFT_OUT, 3)


@lru_cache(maxsize=1)
def far_limit() -> float:
    """Return the squared distance beyond which a fix is refuted by far, not by its noise."""
    return chi_square.bound(_FAR, 3)
