"""One solution of the window of a start, from one first guess of the heading."""

from dataclasses import dataclass

import gtsam
import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, from_rpy

_ITERATIONS = 20


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The states of a window from one first guess."""

    cost: float
    graph: gtsam.NonlinearFactorGraph
    values: gtsam.Values


def solved(graph: gtsam.NonlinearFactorGraph, guess: gtsam.Values) -> Solution | None:
    """Return the solution that is reached from a first guess; None if there is none."""
    params = gtsam.LevenbergMarquardtParams()
    params.setLinearSolverType("MULTIFRONTAL_QR")
    params.setMaxIterations(_ITERATIONS)
    try:
        found = gtsam.LevenbergMarquardtOptimizer(graph, guess, params).optimize()
    except RuntimeError:  # GTSAM raises it on a singular system
        return None
    cost = float(graph.error(found))
    return Solution(cost, graph, found) if np.isfinite(cost) else None


def levelled(force: Float) -> Float:
    """Return the smallest rotation that turns a force upwards, shape (3, 3)."""
    up = force / np.linalg.norm(force)
    axis = np.cross(up, [0.0, 0.0, 1.0])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return np.eye(3) if up[2] > 0 else from_rpy(np.pi, 0.0, 0.0)
    return exp_so3(axis / sine * np.arctan2(sine, up[2]))
