"""Joint refinement of rotation, translation and scale by point-to-plane distances.

The scale of a structure-from-motion cloud comes from camera positions and is wrong by a percent:
5 cm over 5 m, more than is accepted. Aligners find rigid motions only, so the scale is found here.
"""

from dataclasses import dataclass

import numpy as np
import small_gicp
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3


@dataclass(frozen=True, slots=True, eq=False)
class Similarity:
    """p_target = R (scale · p_source) + t."""

    T_target_source: Float
    scale: float

    def apply(self, points_source: Float) -> Float:
        """Express source points in the target's frame, shape (N, 3)."""
        T = self.T_target_source
        return points_source @ (self.scale * T[:3, :3]).T + T[:3, 3]


class Surface:
    """A target's points with normals, for many fits."""

    def __init__(self, points: Float, normals: Float) -> None:
        self.points, self.normals = points, normals
        self._tree = cKDTree(
            points, balanced_tree=False, compact_nodes=False
        )  # built in half the time

    @classmethod
    def thinned(cls, points: Float, voxel_m: float) -> "Surface":
        """Thin points to a grid and find their normals."""
        cloud, _ = small_gicp.preprocess_points(points, voxel_m, 12, 1)
        return cls(np.array(cloud.points()[:, :3]), np.array(cloud.normals()[:, :3]))

    def joined(self, other: "Surface") -> "Surface":
        """Return both as one surface."""
        return Surface(
            np.vstack([self.points, other.points]), np.vstack([self.normals, other.normals])
        )

    def nearest(self, points: Float, max_distance_m: float) -> tuple[Float, Float]:
        """Return distances [m] (inf beyond the reach) and row numbers of the nearest surface
        points.
        """
        distances, rows = self._tree.query(points, distance_upper_bound=max_distance_m)
        return distances, rows


def refine(
    surface: Surface,
    source: Float,
    start: Similarity,
    reaches_m: tuple[float, ...],
    max_scale_error: float,
) -> Similarity:
    """Refine a similarity by Gauss-Newton on point-to-plane distances, with a shrinking reach.

    Args:
        surface: The target.
        source: Thinned source points [m], shape (N, 3).
        start: Where to begin.
        reaches_m: Largest distance of correspondences in each step [m].
        max_scale_error: The scale stays within 1 ± this.
    """
    now = start
    for reach_m in reaches_m:
        moved = now.apply(source)
        distances, rows = surface.nearest(moved, reach_m)
        paired = np.isfinite(distances)
        if paired.sum() < 20:  # seven unknowns need a few points on several faces
            return now
        now = _step(
            now, moved[paired], surface.points[rows[paired]], surface.normals[rows[paired]], reach_m
        )
        bounded = float(np.clip(now.scale, 1 - max_scale_error, 1 + max_scale_error))
        now = now if bounded == now.scale else _rescaled(now, bounded, moved[paired].mean(axis=0))
    return now


def jacobian(arms: Float, normals: Float) -> Float:
    """Return derivatives of point-to-plane distances by rotation, shift and growth, shape (N, 7).

    Args:
        arms: Moved points from the centre of rotation and growth [m], shape (N, 3).
        normals: Of the planes, shape (N, 3).
    """
    growth = np.einsum("ij,ij->i", arms, normals)
    return np.column_stack([np.cross(arms, normals), normals, growth])


def _step(
    now: Similarity, moved: Float, partners: Float, normals: Float, reach_m: float
) -> Similarity:
    centre = moved.mean(axis=0)
    arms = moved - centre
    residuals = np.einsum("ij,ij->i", moved - partners, normals)
    J = jacobian(arms, normals)
    weights = np.clip(1 - (residuals / reach_m) ** 2, 0, 1) ** 2  # Tukey's biweight
    H = J.T @ (J * weights[:, None]) + 1e-6 * np.eye(7)
    rotation, shift, growth = np.split(-np.linalg.solve(H, J.T @ (weights * residuals)), [3, 6])
    turn, factor = exp_so3(rotation), float(np.exp(growth[0]))
    R, t = now.T_target_source[:3, :3], now.T_target_source[:3, 3]
    return Similarity(
        pose(turn @ R, factor * turn @ (t - centre) + centre + shift), now.scale * factor
    )


def _rescaled(now: Similarity, scale: float, centre: Float) -> Similarity:
    R, t = now.T_target_source[:3, :3], now.T_target_source[:3, 3]
    return Similarity(pose(R, centre + scale / now.scale * (t - centre)), scale)
