"""A heading's standard deviation is set, and what the heading does to other errors is kept."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.start.wide_heading import heading_std, with_heading_std

from executive.geometry.rotation import from_rpy

Z = np.zeros(3)
STATE = InertialState(Inertial(0.0, Z, Z, 0.01), from_rpy(0.3, -0.2, 2.0), Z, Z, Z, Z)
UP = STATE.R_map_imu.T[:, 2]


def covariance(std_rad: float, lever_m: np.ndarray, speed_m_s: np.ndarray) -> np.ndarray:
    """Return the linear covariance of a heading error with the errors that it entails."""
    direction = np.zeros(DIMENSION)
    direction[ROTATION] = UP
    direction[POSITION], direction[VELOCITY] = lever_m, speed_m_s
    return 1e-6 * np.eye(DIMENSION) + std_rad**2 * np.outer(direction, direction)


@pytest.mark.parametrize("std_rad", [0.2, 1.5, 100.0])
def test_a_heading_gets_a_standard_deviation_and_the_lever_arm_stays_as_long(
    std_rad: float,
) -> None:
    lever, speed = np.array([2.0, -1.0, 0.0]), np.array([0.5, 3.0, 0.0])
    P = covariance(0.8, lever, speed)
    assert heading_std(STATE, P) == pytest.approx(0.8, rel=1e-3)
    J = with_heading_std(STATE, P, std_rad)
    after = J @ P @ J.T
    wanted = min(std_rad, np.pi / np.sqrt(3))  # of a heading of which nothing is known
    assert heading_std(STATE, after) == pytest.approx(wanted, rel=1e-3)
    for block, along in ((POSITION, lever), (VELOCITY, speed)):
        by_heading = after[block, ROTATION] @ UP / wanted**2
        assert by_heading == pytest.approx(along, rel=1e-3, abs=1e-5)
        across = np.array([-along[1], along[0], 0.0])
        assert across @ after[block, block] @ across == pytest.approx(1e-6 * along @ along)
    tilt = np.cross(UP, [1.0, 0.0, 0.0])
    assert J[ROTATION, ROTATION] @ tilt == pytest.approx(tilt)
