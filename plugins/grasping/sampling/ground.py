"""The ground around a stone: a plane with height samples, completed where the stone hid it."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.voxels import first_in_cells

_CELL_M = 0.2  # edge of the cells whose lowest points are taken for ground
_BAND_M = 0.2  # deviation of rough ground from its plane
_TRIALS = 100
_STEEPEST = np.cos(np.radians(30.0))
_NEIGHBOURS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A plane and samples of the ground heights around it.

    Attributes:
        normal: Unit normal of the plane, pointing up, shape (3,).
        offset_m: Offset d of the plane n·p = d [m].
        samples: Ground points, one per cell, shape (S, 3); empty if only the plane is known.
        cell_m: Edge of those cells [m].
    """

    normal: Float
    offset_m: float
    samples: Float
    cell_m: float

    def height(self, xy: Float) -> Float:
        """Return the ground height [m] at places (N, 2), shape (N,).

        It is the height of the plane plus the weighted deviation of the nearest samples from it.
        """
        plane = (self.offset_m - xy @ self.normal[:2]) / self.normal[2]
        if not len(self.samples):
            return np.asarray(plane)
        above = (
            self.samples[:, 2]
            - (self.offset_m - self.samples[:, :2] @ self.normal[:2]) / self.normal[2]
        )
        k = min(_NEIGHBOURS, len(self.samples))
        distance, index = cKDTree(self.samples[:, :2]).query(xy, k=list(range(1, k + 1)))
        weight = 1.0 / (distance**2 + (self.cell_m / 2) ** 2)
        return np.asarray(plane + (weight * above[index]).sum(axis=1) / weight.sum(axis=1))


def fit_ground(around: Float, stone: Float, rng: np.random.Generator, scale: float = 1.0) -> Ground:
    """Fit the ground to the points around a stone.

    RANSAC runs on the lowest points of cells (Mascaro 2020, Sec. 5.2 uses all points, which the
    tops of neighbouring stones mislead). With fewer than three such points the ground is a level
    plane at the lowest point of the stone.

    Args:
        around: Points around the stone [m], shape (N, 3).
        stone: Points of the stone [m], shape (T, 3).
        rng: Random generator of the RANSAC trials.
        scale: Factor on the lengths of this file, see `SamplingSettings`.
    """
    cell_m, band_m = scale * _CELL_M, scale * _BAND_M
    low = _lowest_of_cells(around, cell_m)
    normal, offset = np.array([0.0, 0.0, 1.0]), float(stone[:, 2].min())
    if len(low) < 3:
        return Ground(normal, offset, np.empty((0, 3)), cell_m)
    best = 0.0
    for corners in (low[rng.choice(len(low), 3, replace=False)] for _ in range(_TRIALS)):
        n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        length = np.linalg.norm(n)
        if length < 1e-6 * scale**2 or abs(n[2]) < _STEEPEST * length:
            continue
        n = n * np.sign(n[2]) / length
        score = float(np.maximum(0.0, 1 - ((low - corners[0]) @ n / (band_m / 2)) ** 2).sum())
        if score > best:
            best, normal, offset = score, n, float(corners[0] @ n)
    normal, offset = _refined(low, normal, offset, band_m)
    return Ground(normal, offset, low[np.abs(low @ normal - offset) < band_m], cell_m)


def fill_ground(
    ground: Ground, stone: Float, low_xy: Float, high_xy: Float, spacing_m: float
) -> Float:
    """Return ground points on a grid over a rectangle, shape (G, 3) [m].

    Grid points that would lie above a part of the stone are left out.
    """
    x, y = (np.arange(low, high, spacing_m) for low, high in zip(low_xy, high_xy, strict=True))
    xy = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    filled = np.column_stack([xy, ground.height(xy)])
    beneath = cKDTree(stone[:, :2]).query_ball_point(xy, 1.5 * spacing_m)
    through = np.array(
        [bool(i) and stone[i, 2].min() < z for i, z in zip(beneath, filled[:, 2], strict=True)],
        dtype=bool,
    )
    return np.asarray(filled[~through])


def _refined(low: Float, normal: Float, offset: float, band_m: float) -> tuple[Float, float]:
    inliers = low[np.abs(low @ normal - offset) < band_m / 2]
    if len(inliers) < 3:
        return normal, offset
    middle = inliers.mean(axis=0)
    n = np.linalg.eigh((inliers - middle).T @ (inliers - middle))[1][:, 0]
    n = n if n[2] > 0 else -n
    return (n, float(n @ middle)) if n[2] > _STEEPEST else (normal, offset)


def _lowest_of_cells(points: Float, cell_m: float) -> Float:
    order = np.argsort(points[:, 2], kind="stable")
    return np.asarray(points[order[np.sort(first_in_cells(points[order, :2], cell_m))]])
