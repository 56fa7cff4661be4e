"""The covariance of a state whose heading is so uncertain that errors are not linear in it."""

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
)

from executive.arrays import Float

_UNIFORM_STD_RAD = np.pi / np.sqrt(3)  # of a heading of which nothing is known


def heading_std(state: InertialState, covariance: Float) -> float:
    """Return the standard deviation of the heading [rad]."""
    return float(np.sqrt(_heading(state) @ covariance @ _heading(state)))


def bounded(state: InertialState, covariance: Float) -> Float:
    """Return the factor on errors that bounds the heading's to a whole turn, shape (15, 15)."""
    J, h = np.eye(DIMENSION), _heading(state)
    std_rad = heading_std(state, covariance)
    if std_rad > _UNIFORM_STD_RAD:
        J += (_UNIFORM_STD_RAD / std_rad - 1.0) * np.outer(h, h)
    return J


def moments(state: InertialState, covariance: Float) -> Float:
    """Return the covariance of errors that turn with the heading, shape (15, 15).

    A linear model puts an antenna's carrier on a tangent, where it is on a circle. With a heading
    error θ of standard deviation σ, an error that was d θ is d sin θ, and across it d (1 − cos θ).
    Hence the covariance with θ falls by exp(−σ²/2), and across d there is the variance
    E (1 − cos θ)² = 3/2 − 2 exp(−σ²/2) + exp(−2 σ²)/2 (of a Gaussian θ).
    """
    h = _heading(state)
    bound = bounded(state, covariance)
    P = bound @ covariance @ bound.T
    variance = float(h @ P @ h)
    by_heading = P @ h / variance - h  # of all other errors, by one radian of heading
    rho = np.exp(-0.5 * variance)
    across = np.zeros(DIMENSION)
    for block in (VELOCITY, POSITION):
        across[block] = np.cross([0.0, 0.0, 1.0], by_heading[block])
    lost = (1.0 - rho) * variance * np.outer(h, by_heading)
    curved = 1.5 - 2.0 * rho + 0.5 * np.exp(-2.0 * variance)
    return np.asarray(P - lost - lost.T + curved * np.outer(across, across))


def _heading(state: InertialState) -> Float:
    """Return the derivative of the heading by the error of the state, shape (15,)."""
    h = np.zeros(DIMENSION)
    h[ROTATION] = state.R_map_imu.T[:, 2]
    return h
