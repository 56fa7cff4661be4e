"""What one linear correction leaves out of a fix counts as noise of the fix."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import moved_far
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from scipy.stats import chi2

from executive.arrays import Float
from executive.geometry.rotation import from_rpy

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 1e-2, 9.81, 0.01)
ARM, FIX_M = np.array([0.5, -1.0, 2.0]), 0.01


def state() -> InertialState:
    z = np.zeros(3)
    sample = Inertial(0.0, z, np.array([0.0, 0.0, 9.81]), 0.01)
    return InertialState(sample, from_rpy(0.02, -0.03, 1.0), z, z, z, z)


def covariance(heading_rad: float, away_m: float, shared: float = 0.0) -> Float:
    """Return that of a body that was without fixes: its heading and its place are unknown."""
    P = 1e-6 * np.eye(DIMENSION)
    P[2, 2] += heading_rad**2
    P[POSITION, POSITION] += away_m**2 * np.eye(3)
    P[2, 6] = P[6, 2] = shared * heading_rad * away_m
    return P


def noise_of(kalman: ErrorStateFilter, arm: Float) -> Float:
    """Return the noise of a fix beside a filter [m²], shape (3, 3)."""
    measured = Fix(0.0, "top", arm, np.zeros(3), FIX_M**2 * np.eye(3))
    return fix_residual(kalman, measured, 0.0)[3].copy()


@pytest.mark.parametrize("shared", [0.0, 0.8, -0.8])
def test_the_noise_is_that_of_what_a_linear_prediction_leaves_out(shared: float) -> None:
    P, here = covariance(0.2, 3.0, shared), state()
    root, rng, left = np.linalg.cholesky(P), np.random.default_rng(3), []
    at = here.p_map_imu + here.R_map_imu @ ARM
    for _ in range(10000):
        error = root @ rng.normal(size=DIMENSION)
        truth, _ = moved_far(here, error)
        turned = here.R_map_imu @ np.cross(error[ROTATION], ARM)
        first = error[POSITION] + turned  # of the antenna, to first order
        left.append(truth.p_map_imu + truth.R_map_imu @ ARM - at - first)
    noise = noise_of(ErrorStateFilter(here, P, NOISE), ARM)
    expected = np.array(left).T @ left / len(left)
    assert noise - FIX_M**2 * np.eye(3) == pytest.approx(expected, abs=0.1 * expected.max())


def test_a_fix_on_a_state_that_is_known_keeps_its_noise() -> None:
    noise = noise_of(ErrorStateFilter(state(), covariance(0.005, 0.005), NOISE), ARM)
    assert np.array_equal(noise, FIX_M**2 * np.eye(3))


def test_a_clock_that_fixes_have_told_apart_adds_nothing() -> None:
    """Its error and the place along the way are large, and known to be the same."""
    P, v = covariance(0.2, 0.001), np.array([10.0, 0.0, 0.0])
    clock_s = 0.1
    P[POSITION, POSITION] += clock_s**2 * np.outer(v, v)
    cross = np.zeros(DIMENSION)
    cross[POSITION] = clock_s**2 * v
    moving = InertialState(state().sample, np.eye(3), np.zeros(3), v, np.zeros(3), np.zeros(3))
    kalman = ErrorStateFilter(moving, P, NOISE, ClockOffset(0.0, clock_s, cross))
    noise = noise_of(kalman, np.zeros(3))
    assert np.sqrt(np.diag(noise).max()) < 1.1 * FIX_M


def test_fixes_after_an_outage_do_not_tell_a_heading_that_they_do_not_show() -> None:
    """A linear correction took the bend for a measurement: 2 of 100 headings were inside.

    What is neglected is the same at each fix, and counts as noise of each: hence not 95.
    """
    rng, P, inside = np.random.default_rng(6), covariance(0.3, 5.0, 0.5), []
    root, here = np.linalg.cholesky(P), state()
    for _ in range(200):
        truth, _ = moved_far(here, root @ rng.normal(size=DIMENSION))
        kalman = ErrorStateFilter(here, P, NOISE)
        for _ in range(6):
            z = truth.p_map_imu + truth.R_map_imu @ ARM + rng.normal(0.0, FIX_M, 3)
            fix = Fix(0.0, "top", ARM, z, FIX_M**2 * np.eye(3))
            residual, H, by_clock, noise = fix_residual(kalman, fix, 0.0)
            kalman.correct(residual, H, noise, np.inf, by_clock)
        off = kalman.state.R_map_imu[:, 0], truth.R_map_imu[:, 0]
        turn = np.arctan2(np.cross(off[0], off[1])[2], off[0] @ off[1])
        inside.append(turn**2 / kalman.covariance[2, 2] < chi2.ppf(0.95, 1))
    assert np.mean(inside) > 0.7
