"""Solutions of a window are joined, and what other headings would cost tells what is known."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.start.heading_hypotheses import Hypothesis, most_likely
from executive_plugins.estimation.start.wide_heading import heading_std

from executive.geometry.rotation import from_rpy, skew

Z = np.zeros(3)
ARM_M = np.array([1.0, 0.5, 2.0])
QUARTERS = (np.pi / 2, np.pi, -np.pi / 2)


def hypothesis(heading_rad: float, cost: float) -> Hypothesis:
    """A heading known to 0.1 rad, with a body that hangs on its antenna in the origin."""
    R = from_rpy(0.0, 0.0, heading_rad)
    state = InertialState(Inertial(0.0, Z, Z, 0.01), R, -R @ ARM_M, Z, Z, Z)
    P = 1e-6 * np.eye(DIMENSION)
    P[2, 2] = 0.1**2
    around = np.eye(DIMENSION)
    around[POSITION, ROTATION] = R @ skew(ARM_M)
    return Hypothesis(cost, state, around @ P @ around.T, ClockOffset(), 1.0)


def test_a_heading_is_known_if_all_others_would_cost_much() -> None:
    held = [(turn_rad, 40.0) for turn_rad in QUARTERS]
    found, headings, std_rad = most_likely([hypothesis(0.4, 3.0)], held, 0.15)
    assert found.has_heading
    assert headings == 1
    assert std_rad == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("cost", [0.1, -1.0])
def test_a_heading_is_unknown_if_another_explains_the_fixes_as_well(cost: float) -> None:
    held = [(np.pi / 2, 40.0), (np.pi, cost), (-np.pi / 2, 40.0)]
    found, _, std_rad = most_likely([hypothesis(0.4, 3.0)], held, 0.15)
    assert not found.has_heading
    assert std_rad > 0.9 * np.pi / np.sqrt(2)  # half of the probability is half a turn away
    wide = heading_std(found.state, found.covariance)
    assert wide == pytest.approx(np.pi / np.sqrt(3), rel=1e-3)
    known = np.zeros((3, DIMENSION))
    known[:, ROTATION], known[:, POSITION] = -found.state.R_map_imu @ skew(ARM_M), np.eye(3)
    assert np.diag(known @ found.covariance @ known.T).max() < 0.01**2


def test_two_headings_about_one_antenna_leave_the_antenna_known() -> None:
    found, headings, _ = most_likely([hypothesis(0.4, 3.0), hypothesis(2.0, 3.5)], [], 0.15)
    assert headings == 2
    assert not found.has_heading
    known = np.zeros((3, DIMENSION))
    known[:, ROTATION], known[:, POSITION] = -found.state.R_map_imu @ skew(ARM_M), np.eye(3)
    assert np.diag(known @ found.covariance @ known.T).max() < 0.01**2
    assert heading_std(found.state, found.covariance) > 0.7
