"""The prediction of a packed filter, through several samples in one compiled call."""

import math

import numpy as np
from executive_plugins.estimation.inertial.clock_offset import CLOCK_WALK_S
from executive_plugins.estimation.inertial.steady_rate import STEADY_S, USUAL_CHANGE
from executive_plugins.estimation.inertial.strapdown import step_into
from executive_plugins.estimation.inertial.usual_motion import (
    PERIOD_S,
    add_motion,
    usual_acceleration,
    usual_rate,
)
from executive_plugins.estimation.kalman.layout import FILTER_TYPE, Block, matrix
from executive_plugins.estimation.live.layout import SAMPLE
from numba import from_dtype, njit, types

from executive.arrays import Float

_LONG_GAP_S = 0.1  # over a longer gap, the samples do not describe the motion
_REAL = types.float64
_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
SAMPLES_TYPE = from_dtype(SAMPLE)[::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def acceleration_of(s: np.record, after: Float) -> None:
    """Write the acceleration at the newest sample, map axes [m/s²], shape (3,)."""
    force, b = s.sample.force, s.accel_bias
    x, y, z = force[0] - b[0], force[1] - b[1], force[2] - b[2]
    for i in range(3):
        after[i] = s.R[i, 0] * x + s.R[i, 1] * y + s.R[i, 2] * z
    after[2] -= s.gravity_m_s2


@njit(cache=True)  # type: ignore[untyped-decorator]
def _follow_motion(s: np.record, stamp_s: float) -> None:
    """Let the motion at the newest sample count as usual, see `UsualMotion`."""
    if stamp_s - s.usual[2] < PERIOD_S:
        return
    acceleration, rate = np.empty(3), np.empty(3)
    acceleration_of(s, acceleration)
    for i in range(3):
        rate[i] = s.sample.rate[i] - s.gyro_bias[i]
    add_motion(s.usual[:], stamp_s, acceleration, rate)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _grow_clock(s: np.record, rate: Float, dt_s: float) -> None:
    """Let the clock walk, and average the rate over the time by which the clock is unknown."""
    s.own[0, 0] += dt_s * CLOCK_WALK_S**2
    weight, slowly = dt_s / (dt_s + math.sqrt(s.own[0, 0])), dt_s / (dt_s + STEADY_S)
    for i in range(3):
        s.mean_rate[i] += weight * (rate[i] - s.mean_rate[i])
        s.slow_rate[i] += slowly * (rate[i] - s.slow_rate[i])


@njit(cache=True)  # type: ignore[untyped-decorator]
def steady_rate(s: np.record, after: Float) -> None:
    """Write the rate by which an antenna moves while the clock is unknown, shape (3,) [rad/s].

    It is the mean over a second unless the newest mean differs by more than noise. The noise of a
    short mean moves the antenna in another direction at each fix, and in the one in which it has
    just turned the attitude: both look as if they told the clock.
    """
    apart2, over_s = 0.0, s.sample.since_last_s + 2.0 * math.sqrt(s.own[0, 0])
    for i in range(3):
        apart2 += (s.mean_rate[i] - s.slow_rate[i]) ** 2
    is_steady = apart2 <= USUAL_CHANGE * s.densities[0] ** 2 / over_s
    for i in range(3):
        after[i] = (s.slow_rate[i] if is_steady else s.mean_rate[i]) - s.gyro_bias[i]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _inflate(s: np.record, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
    """Do what `inflate` does."""
    for i in range(3):
        s.P[i, i] += rotation_rad**2
        s.P[3 + i, 3 + i] += velocity_m_s**2
        s.P[6 + i, 6 + i] += position_m**2


@njit(cache=True)  # type: ignore[untyped-decorator]
def _step(s: np.record, stamp_s: float, rate: Float, force: Float) -> None:
    """Propagate state and covariances to a sample, and store it."""
    k, newest, dt_s = s.companions, s.sample, stamp_s - s.sample.stamp_s
    cross = matrix(s.cross_after, 15, k)
    step_into(
        s.P,
        s.cross[:, :k],
        s.R,
        s.p,
        s.v,
        s.gyro_bias,
        s.accel_bias,
        newest.rate,
        newest.force,
        rate,
        force,
        s.densities,
        dt_s,
        s.gravity_m_s2,
        s.P_after[:],
        cross,
        s.R_after[:],
        s.vectors_after[0],
        s.vectors_after[1],
    )
    for i in range(15):
        for j in range(15):
            s.P[i, j] = s.P_after[i, j]
        for j in range(k):
            s.cross[i, j] = cross[i, j]
    newest.stamp_s = stamp_s
    for i in range(3):
        newest.rate[i], newest.force[i] = rate[i], force[i]
        s.p[i], s.v[i] = s.vectors_after[0, i], s.vectors_after[1, i]
        for j in range(3):
            s.R[i, j] = s.R_after[i, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _predict(s: np.record, stamp_s: float, since_last_s: float, rate: Float, force: Float) -> None:
    """Propagate to a sample; a gap in the samples inflates the covariance."""
    dt_s = stamp_s - s.sample.stamp_s
    if dt_s <= 0:
        return
    if s.clocks:
        _grow_clock(s, rate, dt_s)
    s.sample.since_last_s = since_last_s
    if not since_last_s > _LONG_GAP_S:
        _follow_motion(s, stamp_s)
        _step(s, stamp_s, rate, force)
        return
    # The body goes on at constant velocity: a sample after a gap does not tell of the gap.
    even_rate, even_force = np.empty(3), np.empty(3)
    for i in range(3):
        even_rate[i] = s.gyro_bias[i]
        even_force[i] = s.accel_bias[i] + s.R[2, i] * s.gravity_m_s2
    _step(s, stamp_s, even_rate, even_force)
    s.gap_s = stamp_s
    # A share of the gap's variance, since the gap may be integrated in several parts.
    share_s = math.sqrt(since_last_s * dt_s)
    velocity_m_s = usual_acceleration(s.usual[:]) * share_s
    _inflate(s, 0.5 * since_last_s * velocity_m_s, velocity_m_s, usual_rate(s.usual[:]) * share_s)


@njit(cache=True)  # type: ignore[untyped-decorator]
def follow_samples(s: np.record, ring: Block, first: int, end: int, until_s: float) -> int:
    """Do what `predict_until` does, for callers in compiled code."""
    n = len(ring)
    first = max(first, end - n)
    while first < end and ring[first % n].stamp_s <= until_s:
        one = ring[first % n]
        _predict(s, one.stamp_s, one.since_last_s, one.rate, one.force)
        first += 1
    if first < end and s.sample.stamp_s < until_s:
        one = ring[first % n]
        _predict(s, until_s, one.since_last_s, one.rate, one.force)
    return first


@njit(types.int64(FILTER_TYPE, SAMPLES_TYPE, types.int64, types.int64, _REAL), cache=True)  # type: ignore[untyped-decorator]
def predict_until(block: Block, ring: Block, first: int, end: int, until_s: float) -> int:
    """Propagate through samples up to a time, the last one cut off there.

    Args:
        block: The filter, shape (1,), dtype `FILTER`.
        ring: The newest samples, dtype `SAMPLE`; number k is in row k modulo its length.
        first, end: Number of the first sample, and number after the last.
        until_s: The time [s].

    Returns:
        The number of the first sample that was not used up.
    """
    return int(follow_samples(block[0], ring, first, end, until_s))


@njit(types.void(FILTER_TYPE, _REAL, _REAL, _VECTOR, _VECTOR), cache=True)  # type: ignore[untyped-decorator]
def predict(block: Block, stamp_s: float, since_last_s: float, rate: Float, force: Float) -> None:
    """Propagate to a sample, see `Inertial`."""
    _predict(block[0], stamp_s, since_last_s, rate, force)


@njit(types.void(FILTER_TYPE, _REAL, _REAL, _REAL), cache=True)  # type: ignore[untyped-decorator]
def inflate(block: Block, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
    """Add variance to the state: standard deviations of position, velocity and rotation."""
    _inflate(block[0], position_m, velocity_m_s, rotation_rad)
