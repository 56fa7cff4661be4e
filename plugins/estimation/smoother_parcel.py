"""What crosses the border to the smoother's process, packed: a pickle of many small objects costs ten times as much."""

import pickle
from collections.abc import Sequence

import numpy as np

from executive.arrays import Float
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.inertial_state import DIMENSION, Inertial, InertialState

_SAMPLE = 8  # stamp, time since the last, rate, force
_STATE = _SAMPLE + 21


def packed_samples(samples: Sequence[Inertial]) -> Float:
    """Return samples as rows of stamp, time since the last, rate and force, shape (n, 8)."""
    rows = np.empty((len(samples), _SAMPLE))
    for row, sample in zip(rows, samples, strict=True):
        _write_sample(row, sample)
    return rows


def samples_of(rows: Float) -> list[Inertial]:
    """Return the samples of rows, shape (n, 8)."""
    return [_read_sample(row) for row in rows]


def packed_estimate(estimate: Estimate | None) -> bytes:
    """Return an estimate, or that there is none, as bytes."""
    if estimate is None:
        return b""
    state, numbers = estimate.state, np.empty(_STATE + DIMENSION**2)
    _write_sample(numbers[:_SAMPLE], state.sample)
    parts = (state.R_map_imu.ravel(), state.p_map_imu, state.v_map_imu, state.gyro_bias, state.accel_bias)
    np.concatenate(parts, out=numbers[_SAMPLE:_STATE])
    numbers[_STATE:] = estimate.covariance.ravel()
    words = (numbers.tobytes(), estimate.mode, estimate.changes, dict(estimate.refused))
    return pickle.dumps(words, pickle.HIGHEST_PROTOCOL)


def estimate_of(parcel: bytes) -> Estimate | None:
    """Return the estimate of bytes that the smoother's own process has packed."""
    if not parcel:
        return None
    content, mode, changes, refused = pickle.loads(parcel)
    numbers = np.frombuffer(content)
    R, (p, v, gyro_bias, accel_bias) = numbers[8:17].reshape(3, 3), numbers[17:_STATE].reshape(4, 3)
    state = InertialState(_read_sample(numbers), R, p, v, gyro_bias, accel_bias)
    return Estimate(state, numbers[_STATE:].reshape(DIMENSION, DIMENSION), mode, changes, refused)


def _write_sample(row: Float, sample: Inertial) -> None:
    row[0], row[1], row[2:5], row[5:8] = sample.stamp_s, sample.since_last_s, sample.rate, sample.force


def _read_sample(row: Float) -> Inertial:
    return Inertial(float(row[0]), row[2:5], row[5:8], float(row[1]))
