"""A path through joint space: cubic Hermite curves through nodes, over a parameter that is close to
time.
"""

import numpy as np
from scipy.interpolate import PchipInterpolator

from executive.arrays import Bool, Float

# Straight lines are laid longer than their joints' speed limits ask: their ends turn into the
# travel, which bends less then, and the timing runs faster along them. Of 1 … 7, five halves the
# time lost there; more gains little.
_EASE = 5.0
_LEAST = 1e-3  # shortest interval of the parameter: nodes that coincide are no problem


class HermitePath:
    """Passes all nodes with a continuous tangent and without overshoot between them.

    The tangents are those of monotone Hermite interpolation (Fritsch and Carlson 1980): a joint
    that turns round at a node stands still there, and no joint leaves the range that its nodes
    span. The paper interpolates waypoints with Hermite splines and does not say how tangents are
    chosen (Mascaro 2020, Sec. 6.1).
    """

    def __init__(self, nodes: Float, parameters: Float) -> None:
        self.parameters = parameters
        self._curve = PchipInterpolator(parameters, nodes, axis=0)
        self._derivatives = (self._curve.derivative(1), self._curve.derivative(2))

    @property
    def length(self) -> float:
        """Last value of the parameter; the first is 0."""
        return float(self.parameters[-1])

    def position(self, u: Float) -> Float:
        """Return joint positions at parameters (m,), shape (m, n)."""
        return np.asarray(self._curve(u))

    def tangent(self, u: Float) -> Float:
        """Return dq/du at parameters (m,), shape (m, n)."""
        return np.asarray(self._derivatives[0](u))

    def curvature(self, u: Float) -> Float:
        """Return d²q/du² at parameters (m,), shape (m, n); it steps at nodes."""
        return np.asarray(self._derivatives[1](u))


def path_through(
    nodes: Float, is_dense: Bool, max_velocity: Float, max_acceleration: Float
) -> HermitePath:
    """Lay a path through nodes, each interval about as long as the slowest joint needs for it.

    Args:
        nodes: Joint positions, shape (K, n), K ≥ 2.
        is_dense: For each interval whether it is a piece of a longer curve, passed at speed, shape
            (K − 1,).
        max_velocity: Of the joints, shape (n,).
        max_acceleration: Of the joints, shape (n,).
    """
    steps = np.abs(np.diff(nodes, axis=0))
    passing = _EASE * (steps / max_velocity).max(axis=1)
    # A cubic from rest to rest over h: peak velocity 1.5 Δ/h, peak acceleration 6 Δ/h².
    resting = np.maximum(1.5 * steps / max_velocity, np.sqrt(6 * steps / max_acceleration)).max(
        axis=1
    )
    lengths = np.maximum(np.where(is_dense, passing, resting), _LEAST)
    return HermitePath(nodes, np.concatenate([[0.0], np.cumsum(lengths)]))
