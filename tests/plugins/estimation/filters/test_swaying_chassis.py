"""A chassis that stands on legs, and leans on them: its gyroscope tells that from rest."""

import numpy as np
import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.graph.dual_graph import DualGraph

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy, log_so3
from executive.messages.imu import ImuSample

BEGINS_S, PERIOD_S, FASTEST_RAD_S = 6.0, 3.0, 0.025  # the arm swings out and back


@pytest.fixture
def swaying(cabin):
    """The cabin fixture on a chassis that leans about its feet and back, twice in nine seconds."""

    class Swaying(type(cabin)):
        def lean_rad(self, t: float) -> float:
            u, w = (t - BEGINS_S) % (3 * PERIOD_S), 2 * np.pi / PERIOD_S
            sways = t > BEGINS_S and u < 2 * PERIOD_S
            return FASTEST_RAD_S / w * (1 - np.cos(w * u)) if sways else 0.0

        def T_map_link(self, link: str, t: float) -> np.ndarray:
            feet = pose(None, np.array([0.0, 0.0, -self.machine.stance.base_height_m]))
            lean = feet @ pose(from_rpy(self.lean_rad(t), 0.6 * self.lean_rad(t), 0.0))
            T_map_base = self.T_map_base @ lean @ inverse(feet)
            if link != self.machine.cabin_link:
                return T_map_base
            return T_map_base @ self.machine.joints[0].T_parent_joint

        def T_map_cabin(self, t: float) -> np.ndarray:
            return self.T_map_link(self.machine.cabin_link, t)

        def imu(self, name: str, t: float, rng: np.random.Generator, dt: float = 0.01) -> ImuSample:
            sensor = self.machine.sensors[name]
            before, middle, after = (
                self.T_map_link(sensor.link, one) @ sensor.T_link_sensor
                for one in (t - dt, t - dt / 2, t)
            )
            speeds = (after - middle)[:3, 3], (middle - before)[:3, 3]
            pull = 4 * (speeds[0] - speeds[1]) / dt**2 + np.array([0, 0, 9.81])
            return ImuSample(
                t,
                name,
                log_so3(before[:3, :3].T @ after[:3, :3]) / dt
                + self.gyro_bias
                + rng.normal(0, sensor.gyro_noise_rad_s, 3),
                middle[:3, :3].T @ pull
                + self.accel_bias
                + rng.normal(0, sensor.accel_noise_m_s2, 3),
            )

    return Swaying(cabin.machine, swing_rad=0.0)


@pytest.mark.parametrize("kind", [DualGraph, GnssImuFilter])
def test_a_lean_is_not_mistaken_for_rest(kind, swaying, machine, run, errors_m) -> None:
    estimator = kind(kind.Settings(), machine)
    estimator.start()
    states = run(estimator, swaying.observations(20.0))
    assert {state.status for state in states if state.stamp_s > 3.0} == {"GLOBAL"}
    assert errors_m(swaying, states, 3.0).max() < 0.02
