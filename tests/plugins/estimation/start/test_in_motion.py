"""One antenna: the heading comes from the first metres, in any direction of motion."""

import numpy as np
import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import GnssImuSettings

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.rotation import from_rpy, yaw_of
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample

DATUM = np.array([47.4084, 8.5106, 440.0])
NOISE = {
    "gyro_noise_rad_s": 0.002,
    "gyro_bias_rad_s": 0.002,
    "gyro_walk_rad_s": 2e-5,
    "accel_noise_m_s2": 0.02,
    "accel_bias_m_s2": 0.03,
    "accel_walk_m_s2": 3e-4,
}


@pytest.fixture
def car():
    mounted = {"link": "base", "provenance": "guess"}
    imu = {"kind": "imu", "name": "imu", "rate_hz": 100, **NOISE, **mounted}
    gnss = {
        "kind": "gnss",
        "name": "gnss",
        "rate_hz": 4,
        "horizontal_noise_m": 0.01,
        "vertical_noise_m": 0.02,
    }
    return Rig.model_validate({"name": "car", "sensors": {"imu": imu, "gnss": {**gnss, **mounted}}})


def drive(estimator, yaw, direction, seconds, gyro_bias=0.0, late_s=0.0):
    """Rest for 5 s, then accelerate by 1 m/s² along a body axis; return the estimator's states.

    The stamps of the fixes are late by `late_s`.
    """
    rng = np.random.default_rng(3)
    R, states = from_rpy(0, 0, yaw), []
    forward = R @ np.asarray(direction, dtype=float)
    for k in range(round(100 * seconds)):
        t = k / 100
        u = max(0.0, t - 5.0)
        if k % 25 == 0:
            p = 0.5 * u * u * forward + rng.normal(0, 0.005, 3)
            estimator.add_gnss(
                GnssFix(t + late_s, "gnss", geodetic_from_enu(p, DATUM), np.eye(3) * 1e-4, True)
            )
        force = R.T @ (forward * (u > 0) + [0, 0, 9.81]) + rng.normal(0, 0.02, 3)
        estimator.add_imu(ImuSample(t, "imu", gyro_bias + rng.normal(0, 0.002, 3), force))
        states.append(estimator.state())
    return states


@pytest.mark.parametrize("direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0)])
@pytest.mark.parametrize("yaw", [-2.5, 0.4])
def test_the_heading_is_found_forwards_backwards_and_sideways(car, yaw, direction):
    estimator = GnssImuFilter(GnssImuSettings(imu="imu"), car)
    estimator.start()
    states = drive(estimator, yaw, direction, 14.0)
    ready = [state for state in states if state.is_ready]
    assert 5.5 < ready[0].stamp_s < 8.0  # the motion begins at 5 s
    assert abs(yaw_of(states[-1].T_map_base[:3, :3]) - yaw) < 0.02
    np.testing.assert_allclose(
        states[-1].v_map_cabin, from_rpy(0, 0, yaw) @ direction * 9.0, atol=0.1
    )


def test_a_gyroscope_with_a_large_bias_starts_all_the_same(car):
    sensors = car.model_dump()["sensors"]
    sensors["imu"]["gyro_bias_rad_s"] = 0.1
    estimator = GnssImuFilter(
        GnssImuSettings(imu="imu"), Rig.model_validate({"name": "car", "sensors": sensors})
    )
    estimator.start()
    state = drive(estimator, 0.4, (1, 0, 0), 14.0, gyro_bias=0.083)[-1]
    assert state.is_ready
    assert abs(yaw_of(state.T_map_base[:3, :3]) - 0.4) < 0.05


def test_at_rest_one_antenna_gives_a_position_and_no_heading(car):
    estimator = GnssImuFilter(GnssImuSettings(imu="imu"), car)
    estimator.start()
    states = drive(estimator, 0.4, (1, 0, 0), 5.2)
    assert not any(state.is_ready for state in states)
    located = [state for state in states if state.is_located]
    assert located[0].stamp_s < 2.5
    assert {state.status for state in located} == {"ALIGNING"}
    last = located[-1]
    assert np.sqrt(last.covariance[2, 2]) > 1.5  # all headings
    assert np.linalg.norm(last.T_map_base[:2, 3]) < 0.1
    assert "heading" in estimator.account()[-1].reason


def test_a_clock_that_is_late_is_found_and_its_fixes_are_not_taken_for_drift(car):
    estimator = GnssImuFilter(GnssImuSettings(imu="imu", clock_std_s=0.1), car)
    estimator.start()
    state = drive(estimator, 0.4, (1, 0, 0), 14.0, late_s=0.1)[-1]
    u = state.stamp_s - 5.0
    along = from_rpy(0, 0, 0.4).T @ state.T_map_base[:3, 3]
    assert abs(along[0] - 0.5 * u * u) < 0.1  # 0.9 m if the clock were believed
    assert not any("outlier" in reason for reason in estimator.refused)


def test_a_rig_without_a_turn_joint_is_one_body(car):
    assert car.cabin_link == car.base_link == "base"
    estimator = GnssImuFilter(GnssImuSettings(imu="imu"), car)
    estimator.start()
    state = drive(estimator, 0.4, (1, 0, 0), 12.0)[-1]
    np.testing.assert_array_equal(state.T_map_base, state.T_map_cabin)
