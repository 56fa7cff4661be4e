"""Factors against differences, and the order of errors on the way to GTSAM and back."""

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.factors import (
    covariance_of,
    extract,
    fix_factor,
    inertial_factor,
    insert,
    keys,
    late_fix_factor,
    pose_factor,
    prior,
)
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    Inertial,
    InertialState,
    propagate,
    retract,
)

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3, from_rpy

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 1e-2, 9.81, 0.01)
CLOCK = gtsam.symbol("d", 0)
ARM, RATE = np.array([0.5, -1.0, 2.0]), np.array([0.2, -0.1, 0.6])
SPEED = np.array([2.0, -1.0, 0.5])  # of the antenna, in the map


def state(stamp_s: float = 0.0) -> InertialState:
    return InertialState(
        Inertial(stamp_s, RATE, np.array([1.0, 0.5, 9.7]), 0.01),
        from_rpy(0.2, -0.3, 1.0),
        np.array([1.0, 2.0, 3.0]),
        np.array([2.0, -1.0, 0.5]),
        np.array([1e-3, -2e-3, 5e-4]),
        np.array([0.01, -0.02, 0.03]),
    )


def covariance(seed: int = 0) -> Float:
    A = np.random.default_rng(seed).normal(0.0, 0.01, (DIMENSION, 2 * DIMENSION))
    return A @ A.T


def test_a_state_is_the_same_after_gtsam() -> None:
    values = gtsam.Values()
    insert(values, 3, state())
    again = extract(values, 3, state().sample)
    for name in ("R_map_imu", "p_map_imu", "v_map_imu", "gyro_bias", "accel_bias"):
        assert getattr(again, name) == pytest.approx(getattr(state(), name))


def test_a_prior_gives_back_its_covariance_and_holds_its_state() -> None:
    values = gtsam.Values()
    insert(values, 0, state())
    (factor,) = prior(0, state(), covariance())
    assert factor.error(values) == pytest.approx(0.0, abs=1e-12)
    linear = factor.linearize(values)
    R = linear.getA().copy()
    assert list(linear.keys()) == list(keys(0))
    back = covariance_of(R, state().R_map_imu)
    assert back == pytest.approx(covariance(), rel=1e-6, abs=1e-9)


def test_the_error_of_a_prior_is_half_the_squared_distance() -> None:
    P, step = covariance(), 1e-3 * np.random.default_rng(1).normal(size=DIMENSION)
    (factor,) = prior(0, state(), P)
    values = gtsam.Values()
    insert(values, 0, retract(state(), step))
    assert factor.error(values) == pytest.approx(0.5 * step @ np.linalg.solve(P, step), rel=0.02)


@pytest.mark.parametrize("late_s", [0.0, 0.08])
def test_a_late_fix_and_its_derivatives(late_s: float) -> None:
    where = state().p_map_imu + state().R_map_imu @ ARM
    fix = Fix(0.0, "left", ARM, where - late_s * SPEED, 4e-4 * np.eye(3))
    factor = late_fix_factor(0, CLOCK, fix, SPEED)
    values = gtsam.Values()
    insert(values, 0, state())
    values.insert(CLOCK, np.array([late_s]))
    assert factor.error(values) == pytest.approx(0.0, abs=1e-12)
    x, _, _ = keys(0)
    # Off the measurement, in the range where the kernel is quadratic.
    moved = gtsam.Values(values)
    moved.update(CLOCK, np.array([late_s + 0.002]))
    linear = factor.linearize(moved)
    A, b = linear.getA().copy(), linear.getb().copy()
    step = 1e-6
    for i, key in enumerate([*[x] * 6, CLOCK]):
        delta = gtsam.VectorValues()
        size = {x: 6, CLOCK: 1}[key]
        delta.insert(key, step * np.eye(size)[i - {x: 0, CLOCK: 6}[key]])
        linear = factor.linearize(moved.retract(delta))
        after = linear.getb().copy()
        assert (b - after) / step == pytest.approx(A[:, i], abs=2e-3)


def test_the_time_by_which_a_stamp_was_corrected_is_no_error_of_the_clock() -> None:
    where = state().p_map_imu + state().R_map_imu @ ARM
    fix = Fix(0.0, "left", ARM, where, 4e-4 * np.eye(3), late_s=0.08)
    factor = late_fix_factor(0, CLOCK, fix, SPEED)
    for late_s, is_right in ((0.08, True), (0.0, False)):
        values = gtsam.Values()
        insert(values, 0, state())
        values.insert(CLOCK, np.array([late_s]))
        assert (factor.error(values) < 1e-12) == is_right


@pytest.mark.parametrize("make", [fix_factor, lambda node, fix: _late(node, fix)])
def test_a_fix_far_off_pulls_with_a_bounded_force(make) -> None:
    """Half of the square near by, and linear from 1.345 standard deviations on."""
    values = gtsam.Values()
    insert(values, 0, state())
    values.insert(CLOCK, np.zeros(1))
    where = state().p_map_imu + state().R_map_imu @ ARM
    for sigmas, expected in ((1.0, 0.5), (10.0, 1.345 * (10.0 - 1.345 / 2))):
        fix = Fix(0.0, "left", ARM, where + [0.02 * sigmas, 0, 0], 4e-4 * np.eye(3))
        assert make(0, fix).error(values) == pytest.approx(expected)


def _late(node: int, fix: Fix) -> gtsam.NonlinearFactor:
    return late_fix_factor(node, CLOCK, fix, SPEED)


def test_a_lidar_pose_is_wrong_by_its_rotation_and_translation_in_imu_axes() -> None:
    values = gtsam.Values()
    insert(values, 0, state())
    T = pose(state().R_map_imu, state().p_map_imu)
    error = pose(exp_so3(np.array([0.01, 0.0, 0.0])), np.array([0.0, 0.02, 0.0]))
    sigmas = np.array([0.01, 1.0, 1.0, 1.0, 0.02, 1.0])
    factor = pose_factor(0, T @ inverse(error), np.diag(sigmas**2))
    assert factor.error(values) == pytest.approx(0.5 * 2.0, rel=0.02)


def test_samples_between_two_nodes_predict_the_second() -> None:
    first = state()
    later, samples = first, []
    for k in range(1, 41):
        t = k / 100
        rate = RATE + [0.0, 0.3 * t, 0.5 * np.sin(5 * t)]
        samples.append(Inertial(t, rate, np.array([np.cos(3 * t), 0.5, 9.7]), 0.01))
        later = propagate(later, samples[-1], NOISE.gravity_m_s2)
    factor = inertial_factor((0, 1), first, samples, NOISE)
    values = gtsam.Values()
    insert(values, 0, first)
    insert(values, 1, later)
    assert factor.error(values) < 0.01
    off = np.zeros(DIMENSION)
    off[6:9] = 0.05
    wrong = gtsam.Values()
    insert(wrong, 0, first)
    insert(wrong, 1, retract(later, off))
    assert factor.error(wrong) > 1.0
    # A gap of the samples makes the same difference more likely.
    gapped = [*samples[:-1], Inertial(0.4, samples[-1].rate, samples[-1].force, 0.15)]
    assert inertial_factor((0, 1), first, gapped, NOISE).error(wrong) < 0.1 * factor.error(wrong)
