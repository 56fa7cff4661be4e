"""What compiled code does with a filter's row is what the equations say."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.measurement_models import standstill_residual
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import GYRO_BIAS, Inertial, InertialState
from executive_plugins.estimation.kalman.compiled_correction import consider_into, correct_into
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.live.layout import SAMPLE
from executive_plugins.estimation.live.packing import unpacked
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

NOISE = InertialNoise(1e-4, 2e-3, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
T_IMU_CABIN = pose(from_rpy(0.1, -0.2, 2.0), np.array([0.2, -0.3, -0.4]))
SETTINGS = StandstillSettings(velocity_std_m_s=0.02, rate_std_rad_s=0.03)
SLOW, FAST = np.array([0.0, 0.01, 0.02]), np.array([0.0, 0.02, 0.03])


def resting(clock: ClockOffset | None = None, v: float = 0.01) -> ErrorStateFilter:
    A = np.random.default_rng(1).normal(0.0, 0.01, (15, 30))
    sample = Inertial(3.0, np.array([0.02, -0.01, 0.04]), np.array([0.1, 0.2, 9.8]), 0.01)
    zeros = np.zeros(3)
    state = InertialState(sample, from_rpy(0.3, -0.2, 1.1), zeros, np.full(3, v), zeros, zeros)
    return ErrorStateFilter(state, A @ A.T, NOISE, clock or ClockOffset())


@pytest.mark.parametrize("clock", [ClockOffset(), ClockOffset(0.01, 0.02)], ids=["known", "clock"])
@pytest.mark.parametrize("sway", [(0.0, 0.0), (0.04, 0.03)], ids=["still", "sways"])
@pytest.mark.parametrize("rate_cabin", [SLOW, FAST], ids=["slow", "fast"])
def test_a_chassis_at_rest_corrects_velocity_and_a_small_rate(rate_cabin, sway, clock) -> None:
    kalman, parts, (sway_rad_s, sway_m_s) = resting(clock), resting(clock), sway
    rest = ChassisRest(3.0, rate_cabin, sway_rad_s, sway_m_s)
    assert kalman.correct_by_standstill(T_IMU_CABIN, rest, SETTINGS, 22.0)
    residual, H = standstill_residual(parts.state, T_IMU_CABIN[:3, 3])
    assert parts.correct(residual, H, (0.02**2 + sway_m_s**2) * np.eye(3), 22.0)
    if rate_cabin is SLOW:
        H = np.zeros((3, 15))
        H[:, GYRO_BIAS] = -np.eye(3)
        residual = T_IMU_CABIN[:3, :3] @ rate_cabin - parts.state.rate
        assert parts.correct(residual, H, (0.03**2 + sway_rad_s**2) * np.eye(3), 22.0)
    np.testing.assert_allclose(kalman.covariance, parts.covariance, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(kalman.state.v_map_imu, parts.state.v_map_imu, atol=1e-12)
    np.testing.assert_allclose(kalman.state.gyro_bias, parts.state.gyro_bias, atol=1e-12)


def test_a_chassis_that_moves_corrects_nothing() -> None:
    kalman = resting(v=3.0)
    before = kalman.state
    assert not kalman.correct_by_standstill(T_IMU_CABIN, ChassisRest(3.0, SLOW), SETTINGS, 22.0)
    assert kalman.state is before


def drawn(n: int) -> list[Inertial]:
    rng = np.random.default_rng(2)
    stamps_s = 3.0 + np.arange(1, n + 1) / 100
    return [
        Inertial(float(t), rng.normal(0, 0.3, 3), np.array([0, 0, 9.8]) + rng.normal(0, 1, 3), 0.01)
        for t in stamps_s
    ]


@pytest.mark.parametrize("length", [4, 7, 30], ids=["too short", "wraps", "long"])
def test_several_samples_of_a_ring_are_stepped_through_up_to_a_time(length: int) -> None:
    samples, ring = drawn(10), np.zeros(length, SAMPLE)
    for k, one in enumerate(samples):
        ring[k % length] = one.stamp_s, one.since_last_s, one.rate, one.force
    kalman, parts = resting(), resting()
    oldest = max(4, 10 - length)  # as the ring has forgotten those before
    assert kalman.predict_until(ring, 4, 10, 3.086) == 8
    for one in [*samples[oldest:8], samples[8].until(3.086)]:
        parts.predict(one)
    assert kalman.stamp_s == 3.086
    np.testing.assert_array_equal(kalman.covariance, parts.covariance)
    np.testing.assert_array_equal(kalman.state.p_map_imu, parts.state.p_map_imu)


def test_the_row_that_is_reported_is_the_report() -> None:
    for clock in (ClockOffset(), ClockOffset(0.01, 0.02)):
        kalman = resting(clock)
        state, P = kalman.reported()
        found, covariance = unpacked(kalman.packed())
        np.testing.assert_array_equal(covariance, P)
        np.testing.assert_array_equal(found.R_map_imu, state.R_map_imu)
        np.testing.assert_array_equal(found.accel_bias, state.accel_bias)
        assert found.stamp_s == state.stamp_s


def test_what_is_held_is_considered() -> None:
    """Schmidt's filter: the gain of the held quantity is zero, in Joseph's form."""
    rng, n, m, held = np.random.default_rng(4), 16, 3, 15
    A = rng.normal(0, 0.1, (n, 2 * n))
    P, H, residual = A @ A.T, rng.normal(0, 1, (m, n)), rng.normal(0, 0.1, m)
    noise = np.diag([0.01, 0.02, 0.03])
    W, L = np.empty((m, n + 1)), np.empty((m, m))
    after, error = np.empty((n, n)), np.empty(n)
    given = P, H, residual, noise
    correct_into(*given, 1e9, W, L, after, error)
    consider_into(*given, held, W, L, after, error)
    K: Float = np.linalg.solve(H @ P @ H.T + noise, H @ P).T
    K[held] = 0.0
    J = np.eye(n) - K @ H
    np.testing.assert_allclose(after, J @ P @ J.T + K @ noise @ K.T, atol=1e-12)
    np.testing.assert_allclose(error, K @ residual, atol=1e-12)
    assert error[held] == 0.0
    np.testing.assert_array_equal(after, after.T)
