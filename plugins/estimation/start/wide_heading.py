"""The heading's part in the covariance of a state."""

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    ROTATION,
    InertialState,
)

from executive.arrays import Float

UNIFORM_STD_RAD = np.pi / np.sqrt(3)  # of a heading of which nothing is known


def heading_std(state: InertialState, covariance: Float) -> float:
    """Return the standard deviation of the heading [rad]."""
    return float(np.sqrt(heading_gradient(state) @ covariance @ heading_gradient(state)))


def with_heading_std(state: InertialState, covariance: Float, std_rad: float) -> Float:
    """Return the factor on errors that gives the heading a standard deviation, shape (15, 15).

    It is a whole turn's at most. What the heading's error does to all other errors is scaled with
    it: the carrier of an antenna stays as far from it as the lever arm is long.
    """
    h, before_rad = heading_gradient(state), heading_std(state, covariance)
    by_heading = covariance @ h / before_rad**2
    factor = min(std_rad, UNIFORM_STD_RAD) / before_rad
    return np.asarray(np.eye(DIMENSION) + (factor - 1.0) * np.outer(by_heading, h))


def heading_gradient(state: InertialState) -> Float:
    """Return the derivative of the heading by the error of the state, shape (15,)."""
    h = np.zeros(DIMENSION)
    h[ROTATION] = state.R_map_imu.T[:, 2]
    return h
