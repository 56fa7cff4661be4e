"""A fix that tells far more than the state is used in steps."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from executive_plugins.estimation.kalman.gradual_correction import correct_gradually

Z, ARM = np.zeros(3), np.array([1.0, 0.5, 0.8])
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
FIX_STD_M = 0.01


def lost(position_m: float, heading_rad: float = 0.07) -> ErrorStateFilter:
    """Return a filter whose heading error has drawn the position to one side."""
    P = np.diag(np.repeat([1e-6, 1.0, 0.01 * position_m**2 + 1e-4, 1e-8, 1e-6], 3))
    by_heading = np.zeros(15)
    by_heading[2], by_heading[6], by_heading[7] = heading_rad, 0.5 * position_m, position_m
    state = InertialState(Inertial(0.0, Z, np.array([0, 0, 9.81]), 0.01), np.eye(3), Z, Z, Z, Z)
    return ErrorStateFilter(state, P + np.outer(by_heading, by_heading), NOISE)


def fix_at(x: float, y: float) -> Fix:
    p = ARM + [x, y, 0.0]
    return Fix(0.0, "antenna", ARM, p, FIX_STD_M**2 * np.eye(3))


def left_m(kalman: ErrorStateFilter, fix: Fix) -> float:
    """Return how far the fix is from the state after it was used [m]."""
    return float(np.linalg.norm(fix_residual(kalman, fix, 0.0)[0]))


def test_the_state_is_at_a_fix_that_is_metres_off() -> None:
    fix, gradual, at_once = fix_at(2.0, 4.0), lost(3.0), lost(3.0)
    correct_gradually(gradual.block, fix, 1.0, 0.0)
    gradual.forget_object()
    residual, H, by_clock, noise = fix_residual(at_once, fix, 0.0)
    at_once.correct(residual, H, noise, np.inf, by_clock)
    assert left_m(gradual, fix) < 2 * FIX_STD_M
    assert left_m(at_once, fix) > 5 * FIX_STD_M  # which the next fixes take for something else


@pytest.mark.parametrize("scale", [1.0, 4.0])
def test_small_errors_are_corrected_as_by_one_step(scale: float) -> None:
    fix, gradual, at_once = fix_at(0.02, 0.01), lost(0.02, 0.01), lost(0.02, 0.01)
    correct_gradually(gradual.block, fix, scale, 0.0)
    gradual.forget_object()
    residual, H, by_clock, noise = fix_residual(at_once, fix, 0.0)
    at_once.correct(residual, H, scale * noise, np.inf, by_clock)
    assert gradual.state.p_map_imu == pytest.approx(at_once.state.p_map_imu, abs=2e-3)
    assert np.diag(gradual.covariance) == pytest.approx(np.diag(at_once.covariance), rel=0.05)
