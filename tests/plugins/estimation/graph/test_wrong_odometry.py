"""The dual graph on a drive with perfect fixes, beside odometry that drifts or stands still."""

import numpy as np
import pytest
from executive_plugins.estimation.graph.dual_graph import DualGraph
from executive_plugins.estimation.graph.settings import DualGraphSettings

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

DATUM = np.array([47.4084, 8.5106, 440.0])
FIX_STD_M = 0.01
REST_S, END_S = 3.0, 24.0
ARMS = {"front": np.array([0.8, 0.0, 1.0]), "rear": np.array([-0.8, 0.0, 1.0])}
_AT = {"link": "base", "provenance": "guess"}
RIG = Rig.model_validate(
    {
        "name": "car",
        "sensors": {
            "imu": {
                **_AT,
                "kind": "imu",
                "name": "imu",
                "rate_hz": 100,
                "gyro_noise_rad_s": 0.002,
                "gyro_bias_rad_s": 0.002,
                "gyro_walk_rad_s": 2e-5,
                "accel_noise_m_s2": 0.02,
                "accel_bias_m_s2": 0.03,
                "accel_walk_m_s2": 3e-4,
            },
            **{
                name: {
                    **_AT,
                    "kind": "gnss",
                    "name": name,
                    "rate_hz": 4,
                    "xyz_m": tuple(arm),
                    "horizontal_noise_m": FIX_STD_M,
                    "vertical_noise_m": FIX_STD_M,
                }
                for name, arm in ARMS.items()
            },
            "lidar": {
                **_AT,
                "kind": "lidar",
                "name": "lidar",
                "rate_hz": 10,
                "lasers": 16,
                "elevation_rad": (-0.26, 0.26),
                "azimuth_step_rad": 0.0035,
                "range_m": (0.4, 100.0),
                "range_noise_m": 0.02,
            },
        },
    }
)


def _pose(t: float) -> np.ndarray:
    """Rest, then a winding drive that reaches 8 m/s."""
    u = max(0.0, t - REST_S)
    way = 8.0 * (u - 2.0 * (1.0 - np.exp(-u / 2.0)))
    return pose(from_rpy(0.0, 0.0, 0.3 + np.cos(0.05 * way)), _place(way))


def _place(way: float) -> np.ndarray:
    steps = np.linspace(0.0, way, 400)
    yaw = 0.3 + np.cos(0.05 * steps)
    return np.array([np.trapezoid(np.cos(yaw), steps), np.trapezoid(np.sin(yaw), steps), 0.0])


def _increment(k: int, drift: float, frozen_s: tuple[float, float], rng) -> LidarIncrement:
    from_s, to_s = (k - 10) / 100, k / 100
    T = inverse(_pose(from_s)) @ _pose(to_s)
    if frozen_s[0] <= to_s < frozen_s[1]:
        T = np.eye(4)
    T[:3, 3] = (1.0 + drift) * T[:3, 3] + rng.normal(0, 0.003, 3)
    covariance = np.diag(np.repeat([0.001, 0.003], 3) ** 2)
    return LidarIncrement(from_s, to_s, "lidar", T, covariance)


def _driven(drift: float, frozen_s: tuple[float, float]) -> tuple[np.ndarray, DualGraph]:
    """Return the errors of position after the start [m], and the estimator."""
    rng = np.random.default_rng(7)
    estimator = DualGraph(DualGraphSettings(imu="imu"), RIG)
    estimator.start()
    errors, h = [], 0.01
    for k in range(1, round(100 * END_S)):
        t = k / 100
        if k % 10 == 0:
            estimator.add_odometry(_increment(k, drift, frozen_s, rng))
        if k % 25 == 0:
            for name, arm in ARMS.items():
                T = _pose(t)
                p_map = T[:3, :3] @ arm + T[:3, 3] + rng.normal(0, FIX_STD_M, 3)
                geodetic = geodetic_from_enu(p_map, DATUM)
                estimator.add_gnss(GnssFix(t, name, geodetic, np.eye(3) * FIX_STD_M**2, True))
        before, middle, after = _pose(t - h), _pose(t - h / 2), _pose(t)
        a = 4 * (before[:3, 3] - 2 * middle[:3, 3] + after[:3, 3]) / h**2
        turn = (middle[:3, :3].T @ (after[:3, :3] - before[:3, :3]))[1, 0] / h
        rate = np.array([0, 0, turn]) + rng.normal(0, 0.002, 3)
        force = middle[:3, :3].T @ (a + [0, 0, 9.81]) + rng.normal(0, 0.02, 3)
        estimator.add_imu(ImuSample(t, "imu", rate, force))
        state = estimator.state()
        if state.is_ready:
            errors.append(np.linalg.norm(state.T_map_cabin[:3, 3] - _pose(t)[:3, 3]))
    estimator.close()
    return np.array(errors), estimator


@pytest.mark.parametrize(
    ("drift", "frozen_s"),
    [
        pytest.param(0.03, (0.0, 0.0), id="drifts"),
        pytest.param(0.0, (12.0, 17.0), id="stands still", marks=pytest.mark.slow),
    ],
)
def test_wrong_odometry_is_overruled_by_perfect_fixes(drift, frozen_s) -> None:
    errors, estimator = _driven(drift, frozen_s)
    refused = sum(n for reason, n in estimator.refused.items() if reason.startswith(tuple(ARMS)))
    assert len(errors) > 1500
    assert np.percentile(errors, 95) < 3 * FIX_STD_M + 0.02
    assert refused <= 0.01 * 2 * 4 * END_S
