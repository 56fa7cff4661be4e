"""A path in joint space: cubic Hermite curves through nodes, with a parameter close to time."""

import numpy as np
from scipy.interpolate import PchipInterpolator

from executive.arrays import Bool, Float, Int

# Factor on the parameter length of straight lines. With longer lines the path bends less where they
# join the travel, and the timing is faster there. Of the values 1 … 7, five halves the time that is
# lost there; larger ones gain little.
_EASE = 5.0
_LEAST = 1e-3  # shortest interval of the parameter, for nodes that coincide
# Nodes that are nearer along each joint are one [rad] or [m]: 1 mm at 10 m from the axis. Inverse
# kinematics gives the end of a line and its goal so; a joint that goes back by so little between
# them would have to stop there.
_SAME = 1e-4


class HermitePath:
    """Passes all nodes with a continuous tangent and without overshoot between them.

    The tangents are those of monotone Hermite interpolation (Fritsch and Carlson 1980): a joint
    that reverses at a node has zero velocity there, and no joint leaves the range of its nodes. The
    paper interpolates waypoints with Hermite splines and does not state the tangents (Mascaro 2020,
    Sec. 6.1).
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
        """Return d²q/du² at parameters (m,), shape (m, n); it is discontinuous at nodes."""
        return np.asarray(self._derivatives[1](u))


def path_through(
    nodes: Float, is_dense: Bool, max_velocity: Float, max_acceleration: Float
) -> HermitePath:
    """Return a path through nodes; each interval is about as long as its slowest joint needs.

    Args:
        nodes: Joint positions, shape (K, n), K ≥ 2.
        is_dense: For each interval whether it is a piece of a longer curve, passed at speed,
            shape (K − 1,).
        max_velocity: Velocity limits of the joints, shape (n,).
        max_acceleration: Acceleration limits of the joints, shape (n,).
    """
    kept = _apart(nodes)
    nodes, is_dense = nodes[kept], is_dense[kept[1:] - 1]
    steps = np.abs(np.diff(nodes, axis=0))
    passing = _EASE * (steps / max_velocity).max(axis=1)
    # A cubic from rest to rest over h: peak velocity 1.5 Δ/h, peak acceleration 6 Δ/h².
    resting = np.maximum(1.5 * steps / max_velocity, np.sqrt(6 * steps / max_acceleration)).max(
        axis=1
    )
    lengths = np.maximum(np.where(is_dense, passing, resting), _LEAST)
    return HermitePath(nodes, np.concatenate([[0.0], np.cumsum(lengths)]))


def _apart(nodes: Float) -> Int:
    """Return which nodes are passed: the ends, and those that differ from their neighbours."""
    kept = [0]
    for k in range(1, len(nodes) - 1):
        if not _is_same(nodes[k], nodes[kept[-1]]):
            kept.append(k)
    while len(kept) > 1 and _is_same(nodes[kept[-1]], nodes[-1]):
        kept.pop()
    return np.array([*kept, len(nodes) - 1])


def _is_same(one: Float, other: Float) -> bool:
    return bool(np.abs(one - other).max() <= _SAME)
