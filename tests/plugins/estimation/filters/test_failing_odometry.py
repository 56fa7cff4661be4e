"""Odometry that fails while fixes hold the state: the filter without it takes over, unharmed."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings

from executive.geometry.pose import pose
from executive.messages.gnss import GnssFix
from executive.messages.odometry import LidarIncrement

FROM_S = 8.0


def seldom(observations, way):
    """Yield one fix a second of each antenna, and increments whose way is scaled from 8 s on."""
    for one in observations:
        if isinstance(one, GnssFix) and abs(one.stamp_s - round(one.stamp_s)) > 1e-6:
            continue
        if isinstance(one, LidarIncrement) and one.to_s > FROM_S:
            if way is None:
                continue
            T = one.T_from_to
            one = replace(one, T_from_to=pose(T[:3, :3], way * T[:3, 3]))
        yield one


@pytest.fixture
def largest_m(cabin, machine, with_lidar, run, errors_m):
    """Return the largest error of a swinging cabin from 8 s on, and why odometry was refused."""

    def largest_m(way):
        settings = ErrorStateEkfSettings(standing={"is_used": False})
        estimator = ErrorStateEkf(settings, machine)
        estimator.start()
        states = run(estimator, seldom(with_lidar(cabin, cabin.observations(16.0)), way))
        return errors_m(cabin, states, FROM_S).max(), estimator.refused

    return largest_m


@pytest.mark.parametrize("way", [0.5, 2.0])
def test_odometry_with_a_wrong_way_harms_no_state_that_fixes_hold(largest_m, way):
    without_m, _ = largest_m(None)
    off_m, refused = largest_m(way)
    assert off_m < without_m + 0.01  # one increment of the wrong way is 0.1 m
    assert refused["odometry lidar_horizontal: contradicted by fixes and inertial samples"] > 20


def test_sound_odometry_is_used(largest_m):
    assert not any("odometry" in reason for reason in largest_m(1.0)[1])


def test_the_errors_of_a_drift_add_up_along_the_way_since_the_last_fix(machine):
    """Ten increments of 0.1 m that err by 1 % each, all to one side, are 1 cm off in the end."""
    estimator = ErrorStateEkf(ErrorStateEkfSettings(fallback_after_s=10.0), machine)
    estimator.start()
    estimator._used_fix_s = 0.0
    step = pose(np.eye(3), np.array([0.1, 0.0, 0.0]))
    some = [LidarIncrement(k - 1.0, float(k), "lidar", step, np.eye(6)) for k in range(1, 11)]
    variance = sum(map(estimator._drift2, some))
    assert variance == pytest.approx((10 * 0.01 * 0.1) ** 2)
    later = LidarIncrement(99.0, 100.0, "lidar", step, np.eye(6))
    assert estimator._drift2(later) == pytest.approx(estimator._drift2(some[-1]))


def test_late_odometry_does_not_let_the_state_trail_while_fixes_hold_it(cabin, machine, with_lidar):
    estimator = ErrorStateEkf(ErrorStateEkfSettings(standing={"is_used": False}), machine)
    estimator.start()
    late = []
    for one in with_lidar(cabin, cabin.observations(6.0)):
        if isinstance(one, LidarIncrement):
            late.append(one)
            continue
        estimator.add(one)
        if late and late[0].to_s < estimator.state().stamp_s - 0.5:
            estimator.add_odometry(late.pop(0))
    assert estimator.refused["odometry lidar_horizontal: too late"] > 10
