"""The covariance of a motion, from the residuals that it leaves.

Residuals of neighbouring points are correlated: a survey is bent over metres, and a stone seen from
one side pulls to that side. So the points of a cubic metre count as one observation (the robust
covariance of Liang and Zeger 1986, with cells as clusters); the inverse Hessian alone would be some
ten times too certain.

No residual shows a smooth bend over the whole site, so its size is taken from the settings.
"""

import numpy as np
from executive_plugins.registration.similarity import Similarity, Surface, jacobian

from executive.arrays import Float, Int
from executive.messages.alignment import Uncertainty

_CELL_M = 1.0  # edge of the cells whose residuals are one observation
_LEAST_CELLS = 8  # with fewer, their scatter says nothing about seven unknowns


def motion_uncertainty(
    surface: Surface, source: Float, motion: Similarity, reach_m: float, bend_m: float
) -> Uncertainty | None:
    """Return the covariance of rotation and shift about the middle of the points that overlap.

    The scale is unknown too, and is marginalised.

    Args:
        surface: The target.
        source: Thinned source points [m], shape (N, 3).
        motion: The refined motion.
        reach_m: Largest distance of correspondences [m].
        bend_m: Standard deviation of smooth bends of the source [m].

    Returns:
        The uncertainty; None where too little overlaps.
    """
    moved = motion.apply(source)
    distances, rows = surface.nearest(moved, reach_m)
    paired = np.isfinite(distances)
    points, feet, normals = (
        moved[paired],
        surface.points[rows[paired]],
        surface.normals[rows[paired]],
    )
    cells = _cells_of(points)
    count = int(cells.max()) + 1 if len(cells) else 0
    if count < _LEAST_CELLS:
        return None
    centre = points.mean(axis=0)
    residuals = np.einsum("ij,ij->i", points - feet, normals)
    J = jacobian(points - centre, normals)
    parts = (J * residuals[:, None]).T
    scores = np.column_stack([np.bincount(cells, part, count) for part in parts])
    H = np.linalg.inv(J.T @ J + 1e-6 * np.eye(7))
    covariance = count / (count - 7) * H @ (scores.T @ scores) @ H
    radius_m = float(np.sqrt(((points - centre) ** 2).sum(axis=1).mean()))
    bends = np.diag(np.repeat([bend_m / radius_m, bend_m], 3) ** 2)
    return Uncertainty(0.5 * (covariance + covariance.T)[:6, :6] + bends, centre)


def _cells_of(points: Float) -> Int:
    """Return the number of each point's cell, from 0 in the order of x, then y, then z."""
    if not len(points):
        return np.zeros(0, dtype=np.int64)
    cells = np.floor(points / _CELL_M).astype(np.int64)
    cells -= cells.min(axis=0)
    _, deep, high = cells.max(axis=0) + 1
    keys = (cells[:, 0] * deep + cells[:, 1]) * high + cells[:, 2]
    return np.asarray(np.unique(keys, return_inverse=True)[1])
