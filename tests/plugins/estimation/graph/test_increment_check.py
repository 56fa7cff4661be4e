"""Increments of odometry against the inertial prediction, and a standstill against motion."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Increment, Standstill
from executive_plugins.estimation.graph.increment_check import IncrementCheck
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    VELOCITY,
    Inertial,
    InertialState,
    propagate,
)

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3, from_rpy

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
RATE = np.array([0.1, -0.2, 0.5])
SPEED_STD_M_S = np.array([0.01, 0.02, 0.3])
ODOMETRY = np.diag(np.repeat([1e-6, 1e-4], 3))


def moving() -> tuple[GraphWindow, Float]:
    """Return a window over a second of turning motion, and the motion over its second half."""
    state = InertialState(
        Inertial(0.0, RATE, np.array([0.5, 0.0, 9.8]), 0.01),
        from_rpy(0.1, 0.2, 1.2),
        np.zeros(3),
        np.array([1.0, 2.0, 0.0]),
        np.zeros(3),
        np.zeros(3),
    )
    P = 1e-8 * np.eye(15)
    P[VELOCITY, VELOCITY] = np.diag(SPEED_STD_M_S**2)
    samples, poses = SampleBuffer(), []
    samples.append(state.sample)
    window = GraphWindow(NOISE, samples, state, P)
    for k in range(1, 101):
        sample = Inertial(k / 100, RATE, np.array([0.5, 0.0, 9.8]), 0.01)
        samples.append(sample)
        state = propagate(state, sample, NOISE.gravity_m_s2)
        poses.append(pose(state.R_map_imu, state.p_map_imu))
    return window, inverse(poses[49]) @ poses[99]


def admitted(off: Float, gate: float = 32.0) -> Increment | None:
    """Return what becomes of an increment that is off by (rotation, translation), in later axes."""
    window, T = moving()
    wrong = pose(T[:3, :3] @ exp_so3(off[:3]), T[:3, 3] + T[:3, :3] @ off[3:])
    return IncrementCheck(NOISE, gate).admitted(Increment(0.5, 1.0, wrong, ODOMETRY), window, False)


def test_a_right_increment_is_used_as_it_is() -> None:
    used = admitted(np.zeros(6))
    assert used is not None
    assert used.covariance == pytest.approx(ODOMETRY)


@pytest.mark.parametrize("axis", range(6))
def test_the_gate_is_where_noise_and_the_velocity_end(axis: int) -> None:
    window, _ = moving()
    R = window.state_at(1.0).R_map_imu
    variance = np.full(6, 1e-6 + 0.5**2 * 1e-8 + 0.5 * NOISE.gyro_density**2)
    speed = 0.5**2 * R.T @ np.diag(SPEED_STD_M_S**2) @ R
    S = np.diag(variance)
    S[3:, 3:] = speed + (1e-4 + 0.5**3 / 3 * NOISE.accel_density**2) * np.eye(3)
    off = np.eye(6)[axis] * np.sqrt(32.0 / np.linalg.inv(S)[axis, axis])
    assert admitted(0.97 * off) is not None
    # Its own record makes an odometry that is off less certain, so that the gate is a little wider.
    assert admitted(3.0 * off) is None


@pytest.mark.parametrize("factor", [0.5, 1.1, 2.0])
@pytest.mark.parametrize("is_tied", [True, False])
def test_odometry_that_errs_by_a_share_of_the_way_is_refused_while_fixes_hold(
    factor: float, is_tied: bool
) -> None:
    window, T = moving()
    check = IncrementCheck(NOISE, 1e9)
    long = Increment(0.5, 1.0, pose(T[:3, :3], factor * T[:3, 3]), ODOMETRY)
    used = [check.admitted(long, window, is_tied) is not None for _ in range(60)]
    # Without fixes, nothing could outvote it.
    assert not any(used[48:]) if is_tied else all(used)


def test_who_is_refused_is_decided_when_a_lean_begins() -> None:
    """Fixes that drift contradict the estimate first; odometry leans once they have drawn it."""
    window, T = moving()
    check = IncrementCheck(NOISE, 1e9)
    long = Increment(0.5, 1.0, pose(T[:3, :3], 1.2 * T[:3, 3]), ODOMETRY)
    assert check.admitted(long, window, False) is not None
    for _ in range(40):  # the state agrees with the wrong fixes by now
        assert check.admitted(long, window, True) is not None


def test_odometry_is_used_again_when_its_lean_or_the_fixes_end() -> None:
    window, T = moving()
    right = Increment(0.5, 1.0, T, ODOMETRY)
    long = replace(right, T_from_to=pose(T[:3, :3], 1.2 * T[:3, 3]))
    check = IncrementCheck(NOISE, 1e9)
    assert check.admitted(long, window, True) is None
    used = [check.admitted(right, window, True) is not None for _ in range(100)]
    assert not used[0]
    assert all(used[60:])
    assert check.admitted(long, window, True) is None
    check.acquit()
    assert all(check.admitted(long, window, False) is not None for _ in range(10))


def test_sound_odometry_is_used_while_fixes_hold() -> None:
    rng, (window, T) = np.random.default_rng(3), moving()
    check, used = IncrementCheck(NOISE, 32.0), []
    for _ in range(300):
        off = rng.multivariate_normal(np.zeros(6), ODOMETRY)
        near = pose(T[:3, :3] @ exp_so3(off[:3]), T[:3, 3] + off[3:])
        used.append(check.admitted(Increment(0.5, 1.0, near, ODOMETRY), window, True) is not None)
    assert all(used)


def at(speed_m_s: Float) -> InertialState:
    z = np.zeros(3)
    sample = Inertial(5.0, RATE, np.array([0.0, 0.0, 9.81]), 0.01)
    return InertialState(sample, from_rpy(0.0, 0.0, 1.0), z, speed_m_s, z, z)


def test_a_chassis_that_moves_is_not_at_rest_for_a_while() -> None:
    settings = SmootherSettings()
    check = StandstillCheck(settings)
    arm = np.array([-1.0, 0.5, 0.0])
    standing = Standstill(5.0, arm, None)
    resting = -at(np.zeros(3)).R_map_imu @ np.cross(RATE, arm)  # the cabin turns about the axis
    P = 1e-8 * np.eye(15)
    assert check.is_accepted(0.0)
    assert not check.contradicts(standing, at(resting), P)
    assert check.is_accepted(5.0)
    bound_m_s = settings.standing_velocity_std_m_s * np.sqrt(settings.standing_gate)
    for share, is_told in ((0.95, False), (1.1, True)):
        moved = at(resting + [share * bound_m_s, 0.0, 0.0])
        assert check.contradicts(standing, moved, P) == is_told
    assert not check.is_accepted(5.0 + 0.99 * settings.standing_doubt_s)
    assert check.is_accepted(5.0 + settings.standing_doubt_s)
    unsure = StandstillCheck(settings)
    assert not unsure.contradicts(standing, at(resting + [0.2, 0.0, 0.0]), 0.01 * np.eye(15))


def test_a_standstill_gives_the_bias_only_where_the_cabin_rests() -> None:
    check = StandstillCheck(SmootherSettings())
    turning = Standstill(5.0, np.array([1.0, 0.0, 0.0]), None)
    assert len(check.factors(0, turning, at(np.zeros(3)))) == 1
    resting = replace(turning, rate_imu=np.zeros(3))
    assert len(check.factors(0, resting, at(np.zeros(3)))) == 2
