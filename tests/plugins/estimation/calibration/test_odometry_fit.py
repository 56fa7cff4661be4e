"""Odometry beside a known motion: a body that swings and nods, and its sensor turned on it."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from executive_plugins.estimation.calibration.odometry_fit import OdometryProblem
from scipy.spatial.transform import Rotation

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.messages.odometry import LidarIncrement

DECLARED = pose(from_rpy(0.1, -0.2, 1.4), np.array([0.5, -0.3, 0.8]))
TRUE = DECLARED @ pose(from_rpy(0.05, -0.04, 0.1), np.array([0.1, -0.1, 0.05]))
STD = 1e-3  # of an increment [m], [rad]


class Track:
    """The motion as it is; times are in seconds."""

    span_s = 0.0, 61.0

    def at(self, stamps_s):
        t = np.asarray(stamps_s)
        angles = [1.2 * np.sin(0.5 * t), 0.2 * np.sin(0.9 * t), 0.2 * np.cos(1.3 * t)]
        place = [3 * np.sin(0.7 * t), 2 * np.cos(0.5 * t), 0.3 * np.sin(0.4 * t)]
        return Rotation.from_euler("ZYX", np.column_stack(angles)), np.column_stack(place)


class NoisyTrack(Track):
    """The motion as noisy samples tell it."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self._stamps_s = np.arange(0.0, self.span_s[1] + 0.004, 0.004)
        shape = len(self._stamps_s), 3
        self._wander = np.cumsum(rng.normal(0, 0.04 * 0.004, shape), axis=0)

    def at(self, stamps_s):
        R, p = super().at(stamps_s)
        columns = [np.interp(stamps_s, self._stamps_s, one) for one in self._wander.T]
        return R * Rotation.from_rotvec(np.column_stack(columns)), p


def increments(late_s, count=95):
    """Yield what a sensor measures whose stamps are late, five times a second."""
    rng = np.random.default_rng(2)
    stamps = 0.5 + 0.2 * np.arange(count + 1)
    for first, last in pairwise(stamps):
        R, p = Track().at(np.array([first, last]))
        poses = [pose(R[i].as_matrix(), p[i]) @ TRUE for i in (0, 1)]
        noise = rng.normal(0, STD, 6)
        T = inverse(poses[0]) @ poses[1] @ pose(from_rpy(*noise[:3]), noise[3:])
        yield LidarIncrement(first + late_s, last + late_s, "lidar", T, STD**2 * np.eye(6))


def problem(own):
    return OdometryProblem(list(own), Track(), DECLARED, (0.1, 0.3, 0.15))


@pytest.mark.parametrize("late_s", [0.0, 0.004, -0.013, 0.15])
def test_clock_and_mounting_are_found_whatever_the_first_guess_is(late_s) -> None:
    """The nearest guess to the first three is no offset at all."""
    fit = problem(increments(late_s)).solved()
    assert fit is not None
    # The largest of seven errors: three standard deviations and a half.
    assert abs(fit.late_s - late_s) < 3.5 * np.sqrt(fit.covariance[6, 6]) < 0.005
    turn = (Rotation.from_matrix(fit.T_imu_sensor[:3, :3].T @ TRUE[:3, :3])).as_rotvec()
    arm = fit.T_imu_sensor[:3, 3] - TRUE[:3, 3]
    stds = np.sqrt(np.diag(fit.covariance))
    assert (np.abs([*turn, *arm]) < 3.5 * stds[:6]).all()
    assert stds[:3].max() < 0.003
    assert stds[3:6].max() < 0.02


def test_few_increments_are_not_enough() -> None:
    assert [problem(increments(0.0, count)).is_enough for count in (29, 30)] == [False, True]


def test_errors_that_are_alike_for_seconds_widen_the_covariance() -> None:
    """Errors of one size and of random signs, each for ten increments or for one."""
    true = list(increments(0.0, 300))
    alike = np.random.default_rng(5).choice([-1.0, 1.0], (30, 3)).repeat(10, axis=0)
    arms_m = []
    for signs in (np.random.default_rng(6).permutation(alike), alike):
        own = []
        for one, sign in zip(true, signs, strict=True):
            T = one.T_from_to @ pose(np.eye(3), 5e-3 * sign)
            covariance = np.diag([1e-6] * 3 + [26e-6] * 3)
            own.append(replace(one, T_from_to=T, covariance=covariance))
        fit = problem(own).solved()
        assert fit is not None
        # Their size is as declared; the Huber norm counts less of the tails.
        assert 0.8 < fit.misfit < 1.1
        arms_m.append(np.sqrt(np.trace(fit.covariance[3:6, 3:6])))
    assert arms_m[1] > 1.5 * arms_m[0]


def test_noise_of_samples_neither_draws_a_clock_nor_makes_it_certain() -> None:
    """The motion turns by white noise as well: 0.04 rad/s in 250 samples a second.

    Least squares take that for motion that tells of the clock.
    """
    errors, stds = [], []
    for seed in range(3):
        fit = OdometryProblem(
            list(increments(0.013, 150)), NoisyTrack(seed), DECLARED, (0.1, 0.3, 0.15)
        ).solved()
        assert fit is not None
        errors.append(fit.late_s - 0.013)
        stds.append(np.sqrt(fit.covariance[6, 6]))
    assert (np.abs(errors) < 3.0 * np.array(stds)).all()
    assert 0.001 < min(stds) <= max(stds) < 0.005
