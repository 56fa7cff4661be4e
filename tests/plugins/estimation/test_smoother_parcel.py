"""What crosses the border between processes arrives as it was sent."""

import numpy as np

from plugins.estimation.estimator_modes import Mode, ModeChange
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.smoother_parcel import estimate_of, packed_estimate, packed_samples, samples_of


def sample(rng: np.random.Generator) -> Inertial:
    return Inertial(rng.normal(), rng.normal(0, 1, 3), rng.normal(0, 1, 3), rng.normal())


def assert_same(a: Inertial, b: Inertial) -> None:
    assert (a.stamp_s, a.since_last_s) == (b.stamp_s, b.since_last_s)
    np.testing.assert_array_equal(a.rate, b.rate)
    np.testing.assert_array_equal(a.force, b.force)


def test_samples_arrive_as_they_were() -> None:
    rng = np.random.default_rng(1)
    sent = [sample(rng) for _ in range(5)]
    for a, b in zip(sent, samples_of(packed_samples(sent)), strict=True):
        assert_same(a, b)
    assert samples_of(packed_samples([])) == []


def test_an_estimate_arrives_as_it_was() -> None:
    rng = np.random.default_rng(2)
    names = ("p_map_imu", "v_map_imu", "gyro_bias", "accel_bias")
    state = InertialState(sample(rng), rng.normal(0, 1, (3, 3)), *rng.normal(0, 1, (4, 3)))
    changes = (ModeChange(1.5, Mode.GLOBAL, Mode.SUSPECT, "no fix for 0.7 s"),)
    sent = Estimate(state, rng.normal(0, 1, (15, 15)), Mode.SUSPECT, changes, {"gnss_left: outlier": 3})
    got = estimate_of(packed_estimate(sent))
    assert_same(got.state.sample, state.sample)
    for name in ("R_map_imu", *names):
        np.testing.assert_array_equal(getattr(got.state, name), getattr(state, name))
    np.testing.assert_array_equal(got.covariance, sent.covariance)
    assert (got.mode, got.changes, got.refused) == (sent.mode, sent.changes, sent.refused)


def test_no_estimate_arrives_as_none() -> None:
    assert estimate_of(packed_estimate(None)) is None
