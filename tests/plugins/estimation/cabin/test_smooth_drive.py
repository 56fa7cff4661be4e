"""A drive so smooth that the chassis' inertial sensor cannot tell it from rest."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.graph.dual_graph import DualGraph

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import pose
from executive.messages.gnss import GnssFix


@pytest.fixture
def drive(cabin):
    """The cabin fixture on a chassis that gains 0.7 m/s within seven seconds, from the fourth on,
    and does not turn.
    """

    class Drive(type(cabin)):
        def speed(self, t: float) -> float:
            return 0.1 * min(max(t - 4.0, 0.0), 7.0)

        def T_map_cabin(self, t: float) -> np.ndarray:
            rising_s, steady_s = min(max(t - 4.0, 0.0), 7.0), max(t - 11.0, 0.0)
            return pose(
                None, np.array([0.05 * rising_s**2 + 0.7 * steady_s, 0, 0])
            ) @ super().T_map_cabin(t)

        def velocity(self, t: float, sensor: object) -> np.ndarray:
            return super().velocity(t, sensor) + [self.speed(t), 0, 0]

    return Drive(cabin.machine, swing_rad=0.0)


def worst_m(drive, estimator, observations, after_s) -> float:
    worst = 0.0
    for observation in observations:
        estimator.add(observation)
        state = estimator.state()
        if state.is_ready and state.stamp_s > after_s:
            worst = max(
                worst,
                np.linalg.norm(state.T_map_cabin[:3, 3] - drive.T_map_cabin(state.stamp_s)[:3, 3]),
            )
    return worst


@pytest.mark.parametrize("kind", [DualGraph, GnssImuFilter])
def test_it_is_not_mistaken_for_rest(kind, drive, machine) -> None:
    estimator = kind(kind.Settings(), machine)
    estimator.start()
    assert worst_m(drive, estimator, drive.observations(12.0), 3.0) < 0.04
    assert {reason for reason in estimator.refused if "outlier" in reason} == set()


def test_a_filter_with_inflated_covariance_does_not_use_standstill(drive, start) -> None:
    def back_and_forth(observation):
        is_wrong = isinstance(observation, GnssFix) and 9.0 < observation.stamp_s < 14.0
        if not is_wrong:
            return observation
        return replace(
            observation, geodetic=geodetic_from_enu(np.array([0.0, 1.0, 0.0]), observation.geodetic)
        )

    observations = map(back_and_forth, drive.observations(18.0))
    assert worst_m(drive, start(), observations, 17.0) < 0.05
