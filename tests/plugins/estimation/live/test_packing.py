"""Estimates and samples in the shared block are read as they were written."""

import numpy as np
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.layout import LIVE, SAMPLES
from executive_plugins.estimation.live.modes import Mode
from executive_plugins.estimation.live.packing import (
    MODES,
    is_finite,
    packed,
    packed_estimate,
    samples_from,
    unpacked,
)


def sample(rng: np.random.Generator) -> Inertial:
    return Inertial(rng.normal(), rng.normal(0, 1, 3), rng.normal(0, 1, 3), rng.normal())


def some_state(rng: np.random.Generator) -> InertialState:
    return InertialState(sample(rng), rng.normal(0, 1, (3, 3)), *rng.normal(0, 1, (4, 3)))


def assert_same(a: Inertial, b: Inertial) -> None:
    assert (a.stamp_s, a.since_last_s) == (b.stamp_s, b.since_last_s)
    np.testing.assert_array_equal(a.rate, b.rate)
    np.testing.assert_array_equal(a.force, b.force)


def test_an_estimate_is_unpacked_as_it_was_packed() -> None:
    rng = np.random.default_rng(2)
    state, covariance = some_state(rng), rng.normal(0, 1, (15, 15))
    row = packed_estimate(Estimate(state, covariance, Mode.SUSPECT, (), {"gnss_left: outlier": 3}))
    got, got_covariance = unpacked(row)
    assert_same(got.sample, state.sample)
    for name in ("R_map_imu", "p_map_imu", "v_map_imu", "gyro_bias", "accel_bias"):
        np.testing.assert_array_equal(getattr(got, name), getattr(state, name))
    np.testing.assert_array_equal(got_covariance, covariance)
    assert MODES[row["mode"][0]] == Mode.SUSPECT
    row["R"] = 0.0
    assert got.R_map_imu.any()  # a copy


def test_an_estimate_with_a_nan_is_detected() -> None:
    rng = np.random.default_rng(3)
    row = packed(some_state(rng), np.eye(15))
    assert is_finite(row)
    for name in ("R", "p", "gyro_bias", "P"):
        broken = row.copy()
        broken[name].flat[-1] = np.nan
        assert not is_finite(broken)


def test_samples_are_read_across_the_end_of_the_ring_without_overwritten_ones() -> None:
    block = np.zeros(1, LIVE)
    for number in range(
        SAMPLES, SAMPLES + 3
    ):  # the ring has been filled once, and three more have come
        block["samples"][0, number % SAMPLES]["stamp_s"] = number
    for number in range(3, SAMPLES):
        block["samples"][0, number]["stamp_s"] = number
    assert [s.stamp_s for s in samples_from(block, SAMPLES - 2, SAMPLES + 3)] == list(
        range(SAMPLES - 2, SAMPLES + 3)
    )
    assert [s.stamp_s for s in samples_from(block, 0, SAMPLES + 3)] == list(range(3, SAMPLES + 3))
    assert samples_from(block, 5, 5) == []
