"""The dual graph on a drive: odometry that drifts or stands still, and a receiver's own clock."""

import numpy as np
import pytest
from executive_plugins.estimation.graph.dual_graph import DualGraph
from executive_plugins.estimation.graph.settings import DualGraphSettings
from scipy.stats import chi2

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
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


def _driven(
    drift: float = 0.0,
    frozen_s: tuple[float, float] = (0.0, 0.0),
    late_s: float = 0.0,
    fix_period_s: float = 0.25,
    silent_s: tuple[float, float] = (0.0, 0.0),
    **settings,
) -> tuple[list[BaseState], DualGraph]:
    """Return the states after the start, and the estimator."""
    rng = np.random.default_rng(7)
    estimator = DualGraph(DualGraphSettings(imu="imu", **settings), RIG)
    estimator.start()
    states, h = [], 0.01
    for k in range(1, round(100 * END_S)):
        t = k / 100
        if k % 10 == 0:
            estimator.add_odometry(_increment(k, drift, frozen_s, rng))
        if k % round(100 * fix_period_s) == 0 and not silent_s[0] <= t < silent_s[1]:
            for name, arm in ARMS.items():
                T = _pose(t - late_s)
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
            states.append(state)
    estimator.close()
    return states, estimator


def _errors(states: list[BaseState]) -> np.ndarray:
    """Return the errors of position in body axes [m], shape (N, 3)."""
    return np.array([(inverse(s.T_map_cabin) @ _pose(s.stamp_s))[:3, 3] for s in states])


def _errors_m(states: list[BaseState]) -> np.ndarray:
    return np.linalg.norm(_errors(states), axis=1)


@pytest.mark.parametrize(
    ("drift", "frozen_s"),
    [
        pytest.param(0.03, (0.0, 0.0), id="drifts"),
        pytest.param(0.0, (12.0, 17.0), id="stands still", marks=pytest.mark.slow),
    ],
)
def test_wrong_odometry_is_overruled_by_perfect_fixes(drift, frozen_s) -> None:
    states, estimator = _driven(drift, frozen_s)
    assert len(states) > 1500
    assert np.percentile(_errors_m(states), 95) < 3 * FIX_STD_M + 0.02
    assert _refused(estimator) <= 0.01 * 2 * 4 * END_S


def _refused(estimator: DualGraph) -> int:
    """Return the number of fixes that were refused."""
    return sum(n for reason, n in estimator.refused.items() if reason.startswith(tuple(ARMS)))


@pytest.mark.parametrize("late_s", [-0.05, 0.0, 0.05])
def test_a_clock_that_nothing_synchronises_is_estimated_on_the_way(late_s) -> None:
    """At 8 m/s, 50 ms are 0.4 m."""
    states, estimator = _driven(late_s=late_s, clock_std_s=0.1, clock_agrees=0.5)
    last = [state for state in states if state.stamp_s > END_S - 5.0]
    assert {state.status for state in last} == {"GLOBAL"}
    assert np.percentile(_errors_m(last), 95) < 3 * FIX_STD_M + 0.02
    assert _refused(estimator) == 0


@pytest.mark.parametrize("late_s", [0.0, 0.05])
def test_a_state_says_what_an_unknown_clock_leaves_open(late_s) -> None:
    states, _ = _driven(late_s=late_s, clock_std_s=0.1)
    squares = []
    for state, error in zip(states, _errors(states), strict=True):
        squares.append(error @ np.linalg.solve(state.covariance[3:, 3:], error))
    assert np.mean(np.array(squares) < chi2.ppf(0.95, 3)) > 0.9


def test_a_clock_that_is_taken_for_known_shifts_the_state_along_the_way() -> None:
    """The failure that the estimate of the clock prevents."""
    states, _ = _driven(late_s=0.05)
    assert _errors_m(states[-500:]).mean() > 0.3


def test_fixes_that_come_once_a_second_are_not_missing() -> None:
    states, estimator = _driven(fix_period_s=1.0)
    last = [state for state in states if state.stamp_s > 12.0]
    assert {state.status for state in last} == {"GLOBAL"}
    assert np.percentile(_errors_m(last), 95) < 3 * FIX_STD_M + 0.02
    assert _refused(estimator) == 0


def test_fixes_that_come_once_a_second_are_missed_and_used_again() -> None:
    """Two that did not come are missing; five of both antennas that agree are used."""
    states, _ = _driven(fix_period_s=1.0, silent_s=(14.0, 18.0))
    status = {round(state.stamp_s, 2): state.status for state in states}
    assert [status[t] for t in (14.0, 15.4, 16.0, 18.0)] == [
        "GLOBAL", "SUSPECT", "FALLBACK", "RECOVERING"
    ]  # fmt: skip
    assert status[19.5] == "RECOVERING"
    assert status[20.5] == "GLOBAL"
