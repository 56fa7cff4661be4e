"""A bank of filters that differ in heading, for a body whose heading is not known.

Source: the Gaussian sum filter (Alspach and Sorenson 1972). Each filter is linear about its own
heading, and the fixes tell by their likelihood which headings explain them.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.estimation.cabin.aligning_witness import AligningWitness
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import left_jacobian, moved_far
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
    retract,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.wide_heading import UNIFORM_STD_RAD, heading_gradient

from executive.arrays import Float
from executive.geometry.rotation import log_so3

_HEADINGS = 8
# Of the headings between two members, which are equally likely. One member is enough for a heading
# that is known better than that.
_MEMBER_STD_RAD = 2 * np.pi / _HEADINGS / np.sqrt(12)
_REFUTED = 7.0  # a member under which the fixes are e⁷ = 1,100 times less likely is dropped


class HeadingBank:
    """Filters with the likelihood of each."""

    def __init__(self, found: Found, noise: InertialNoise, witness: AligningWitness) -> None:
        """Make the filters that a state without a heading stands for.

        Args:
            found: The state.
            noise: Noise of the inertial sensor.
            witness: What fixes say of the states so far.
        """
        self._noise, self._witness = noise, witness
        self._members = list(_members(found, noise))
        self._weights = np.array([weight for weight, _ in self._members])  # logarithms
        self._filters = [kalman for _, kalman in self._members]

    @property
    def state(self) -> InertialState:
        """The likeliest state."""
        return self._filters[int(np.argmax(self._weights))].state

    @property
    def stamp_s(self) -> float:
        """Time of the states [s]."""
        return self._filters[0].stamp_s

    def predict_until(self, ring: Block, first: int, end: int, until_s: float) -> int:
        """Propagate through samples up to a time; see `packed_prediction.predict_until`."""
        unused = first
        for kalman in self._filters:
            unused = kalman.predict_until(ring, first, end, until_s)
        return unused

    def correct(self, fix: Fix, late_s: float, scale: float, gate: float) -> bool:
        """Correct by a fix; return whether it was within the gate of any filter.

        Args:
            fix: The fix.
            late_s: By how much its stamp was thought to be late when it was queued [s].
            scale: Factor on its variance.
            gate: Largest squared Mahalanobis distance.
        """
        likelihoods = np.full(len(self._filters), -np.inf)
        predictions = []
        for i, kalman in enumerate(self._filters):
            residual, H, by_clock, noise = fix_residual(kalman, fix, late_s)
            S = kalman.predicted(H, by_clock) + scale * noise
            predictions.append((residual, S))
            distance2 = float(residual @ np.linalg.solve(S, residual))
            if kalman.correct(residual, H, scale * noise, gate, by_clock):
                likelihoods[i] = -0.5 * (distance2 + np.linalg.slogdet(S)[1])
        self._witness.take(fix, *self._mixed(predictions))
        if not np.isfinite(likelihoods).any():
            return False
        self._witness.use(fix.stamp_s)
        self._weigh(likelihoods)
        return True

    @property
    def _shares(self) -> Float:
        """Probability of each filter."""
        shares = np.exp(self._weights - self._weights.max())
        return np.asarray(shares / shares.sum())

    def _mixed(self, predictions: Sequence[tuple[Float, Float]]) -> tuple[Float, Float]:
        """Return the mean of the filters' innovations, (3,), and the covariance about it."""
        pairs = list(zip(self._shares, predictions, strict=True))
        mean = np.asarray(sum(share * residual for share, (residual, _) in pairs))
        apart = [(share, residual - mean, S) for share, (residual, S) in pairs]
        return mean, np.asarray(sum(share * (S + np.outer(d, d)) for share, d, S in apart))

    def _weigh(self, likelihoods: Float) -> None:
        """Add logarithms of likelihoods, and drop the filters that they refute."""
        self._weights = self._weights + likelihoods
        kept = np.flatnonzero(self._weights > self._weights.max() - _REFUTED)
        self._filters = [self._filters[i] for i in kept]
        self._weights = self._weights[kept] - self._weights.max()

    def packed(self) -> Block:
        """Return what is reported as a row, see `packing`."""
        return packed(*self.reported())

    def packed_at(self, ring: Block, first: int, end: int, until_s: float) -> tuple[int, Block]:
        """Do what `predict_until` and then `packed` do."""
        return self.predict_until(ring, first, end, until_s), self.packed()

    def reported(self) -> tuple[InertialState, Float]:
        """Return the mean state, and the second moment of its error in map axes, (15, 15).

        The likeliest state alone would turn by the angle between two members when the fixes tell
        a little more for the other.
        """
        shares = self._shares
        best, states = self.state, [kalman.state for kalman in self._filters]
        mean = sum(
            share * _difference(best, one)[0] for share, one in zip(shares, states, strict=True)
        )
        middle, P = retract(best, np.asarray(mean)), np.zeros((DIMENSION, DIMENSION))
        for share, kalman in zip(shares, self._filters, strict=True):
            error, J = _difference(middle, kalman.state)
            P += share * (J @ kalman.reported()[1] @ J.T + np.outer(error, error))
        if self._witness.moved2 is not None:
            P[POSITION, POSITION] += self._witness.moved2
        return middle, P


def _members(found: Found, noise: InertialNoise) -> Iterator[tuple[float, ErrorStateFilter]]:
    """Yield filters with the logarithms of their weights."""
    h = np.append(heading_gradient(found.state), 0.0)
    P = np.empty((DIMENSION + 1, DIMENSION + 1))
    P[:DIMENSION, :DIMENSION], P[-1, -1] = found.covariance, found.clock.std_s**2
    P[:DIMENSION, -1] = P[-1, :DIMENSION] = found.clock.cross
    variance = float(h @ P @ h)
    if variance <= _MEMBER_STD_RAD**2:
        yield 0.0, ErrorStateFilter(found.state, found.covariance, noise, found.clock)
        return
    by_heading = P @ h / variance
    rest = P - (variance - _MEMBER_STD_RAD**2) * np.outer(by_heading, by_heading)
    narrowness = max(0.0, 1 / variance - 1 / UNIFORM_STD_RAD**2)  # 0 if all are equally likely
    for k in range(_HEADINGS):
        heading_rad = 2 * np.pi * (k - _HEADINGS // 2) / _HEADINGS
        error = heading_rad * by_heading
        state, J = moved_far(found.state, error[:DIMENSION])
        late_s = found.clock.offset_s + float(error[-1])
        clock = ClockOffset(
            late_s, float(np.sqrt(max(rest[-1, -1], 0.0))), J @ rest[:DIMENSION, -1]
        )
        covariance = J @ rest[:DIMENSION, :DIMENSION] @ J.T
        weight = -0.5 * narrowness * heading_rad**2
        yield weight, ErrorStateFilter(state, covariance, noise, clock)


def _difference(best: InertialState, other: InertialState) -> tuple[Float, Float]:
    """Return the error of one state if another is true, (15,), and its derivative, (15, 15)."""
    error, J = np.zeros(DIMENSION), np.eye(DIMENSION)
    error[ROTATION] = log_so3(best.R_map_imu.T @ other.R_map_imu)
    error[VELOCITY] = other.v_map_imu - best.v_map_imu
    error[POSITION] = other.p_map_imu - best.p_map_imu
    error[GYRO_BIAS] = other.gyro_bias - best.gyro_bias
    error[ACCEL_BIAS] = other.accel_bias - best.accel_bias
    J[ROTATION, ROTATION] = np.linalg.inv(left_jacobian(-error[ROTATION]))
    return error, J
