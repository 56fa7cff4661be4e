"""One solution of the window of a start, from one first guess of the heading."""

from collections.abc import Sequence
from dataclasses import dataclass

import gtsam
import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, from_rpy

_ITERATIONS = 20


# Velocity of the antenna of each fix of each node in the map [m/s], shapes (3,).
Speeds = Sequence[Sequence[Float]]


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The states of a window from one first guess.

    Attributes:
        cost: Minus the logarithm of its likelihood.
        graph: The factors.
        values: What minimises their cost.
        speeds: Of the antennas, by which an error of the clock moves the fixes; None if the clock
            is known.
    """

    cost: float
    graph: gtsam.NonlinearFactorGraph
    values: gtsam.Values
    speeds: Speeds | None = None


def solved(
    graph: gtsam.NonlinearFactorGraph, guess: gtsam.Values, speeds: Speeds | None = None
) -> Solution | None:
    """Return the solution that is reached from a first guess; None if there is none."""
    params = gtsam.LevenbergMarquardtParams()
    params.setLinearSolverType("MULTIFRONTAL_QR")
    params.setMaxIterations(_ITERATIONS)
    try:
        found = gtsam.LevenbergMarquardtOptimizer(graph, guess, params).optimize()
    except RuntimeError:  # GTSAM raises it on a singular system
        return None
    cost = float(graph.error(found))
    return Solution(cost, graph, found, speeds) if np.isfinite(cost) else None


def levelled(force: Float) -> Float:
    """Return the smallest rotation that turns a force upwards, shape (3, 3)."""
    up = force / np.linalg.norm(force)
    axis = np.cross(up, [0.0, 0.0, 1.0])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return np.eye(3) if up[2] > 0 else from_rpy(np.pi, 0.0, 0.0)
    return exp_so3(axis / sine * np.arctan2(sine, up[2]))
