"""Joint refinement of rotation, translation and scale by point-to-plane distances.

The scale of a structure-from-motion cloud comes from camera positions and is wrong by a percent:
5 cm over 5 m, more than is accepted. Aligners find rigid motions only, so the scale is found here.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import small_gicp
from executive_plugins.registration.thinning import thinned
from numba import njit

from executive.arrays import Float, Int
from executive.geometry.point_grid import PointGrid, compile_point_grid
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3

_NEIGHBOURS = 12  # points that shape a normal
_DAMPING = 1e-6 * np.eye(7)  # of directions that no point determines
_CELL = 3.5  # edge of the cells in which points are looked up, in their distance: the fastest


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
    """A target's points with normals, for many fits.

    Normals and the search are prepared when they are first asked for: many surfaces of a source
    are compared by their points alone.
    """

    def __init__(self, points: Float, normals: Float | None = None, spacing_m: float = 0.1) -> None:
        """Take points (N, 3) [m]; without normals, those of their neighbourhoods are found.

        The search is fastest if points are so far apart [m].
        """
        self.points, self._given, self._spacing_m = points, normals, spacing_m

    @classmethod
    def thinned(cls, points: Float, voxel_m: float) -> "Surface":
        """Thin points to a grid; their normals are found."""
        return cls(thinned(points, voxel_m), None, voxel_m)

    @cached_property
    def normals(self) -> Float:
        """Unit normals, shape (N, 3)."""
        if self._given is not None:
            return self._given
        cloud = small_gicp.PointCloud(self.points)
        small_gicp.estimate_normals(cloud, num_neighbors=_NEIGHBOURS)
        return np.array(cloud.normals()[:, :3], order="C")

    @cached_property
    def _grid(self) -> PointGrid:
        return PointGrid(self.points, _CELL * self._spacing_m)

    def joined(self, *others: "Surface") -> "Surface":
        """Return all as one surface."""
        parts = (self, *others)
        points, normals = (
            np.vstack(both) for both in zip(*((p.points, p.normals) for p in parts), strict=True)
        )
        return Surface(points, normals, self._spacing_m)

    def nearest(self, points: Float, max_distance_m: float) -> tuple[Float, Int]:
        """Return distances [m] (inf beyond the reach) and row numbers of the nearest surface
        points.
        """
        return self._grid.nearest(points, max_distance_m)


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
        near = np.flatnonzero(np.isfinite(distances))
        if len(near) < 20:  # seven unknowns need a few points on several faces
            return now
        H, gradient, centre = _normal_equations(
            moved, near, rows, surface.points, surface.normals, reach_m
        )
        now = _step(now, H, gradient, centre)
        bounded = float(np.clip(now.scale, 1 - max_scale_error, 1 + max_scale_error))
        now = now if bounded == now.scale else _rescaled(now, bounded, centre)
    return now


def compile_refinement() -> None:
    """Compile the inner loops."""
    compile_point_grid()
    few = np.eye(3)
    _normal_equations(few, np.arange(3), np.arange(3), few, few, 1.0)


def jacobian(arms: Float, normals: Float) -> Float:
    """Return derivatives of point-to-plane distances by rotation, shift and growth, shape (N, 7).

    Args:
        arms: Moved points from the centre of rotation and growth [m], shape (N, 3).
        normals: Of the planes, shape (N, 3).
    """
    growth = np.einsum("ij,ij->i", arms, normals)
    return np.column_stack([np.cross(arms, normals), normals, growth])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _normal_equations(
    moved: Float, near: Int, partners: Int, points: Float, normals: Float, reach_m: float
) -> tuple[Float, Float, Float]:  # pragma: no cover - compiled
    """Return Hessian (7, 7), gradient (7,) and centre [m] of the moved points that are near.

    Rows of the Jacobian are those of `jacobian`; weights are Tukey's biweight.
    """
    centre = np.zeros(3)
    for n in near:
        centre += moved[n]
    centre /= len(near)
    H, gradient, J = np.zeros((7, 7)), np.zeros(7), np.empty(7)
    for n in near:
        x, y, z = moved[n] - centre
        u, v, w = normals[partners[n]]
        J[0], J[1], J[2] = y * w - z * v, z * u - x * w, x * v - y * u
        J[3], J[4], J[5] = u, v, w
        J[6] = x * u + y * v + z * w
        foot = points[partners[n]] - centre
        residual = (x - foot[0]) * u + (y - foot[1]) * v + (z - foot[2]) * w
        weight = max(1.0 - (residual / reach_m) ** 2, 0.0) ** 2
        for a in range(7):
            gradient[a] += weight * residual * J[a]
            for b in range(a, 7):
                H[a, b] += weight * J[a] * J[b]
    for a in range(7):
        for b in range(a):
            H[a, b] = H[b, a]
    return H, gradient, centre


def _step(now: Similarity, H: Float, gradient: Float, centre: Float) -> Similarity:
    change = np.asarray(-np.linalg.solve(H + _DAMPING, gradient), dtype=np.float64)
    shift = change[3:6]
    turn, factor = exp_so3(change[:3]), float(np.exp(change[6]))
    R, t = now.T_target_source[:3, :3], now.T_target_source[:3, 3]
    return Similarity(
        pose(turn @ R, factor * turn @ (t - centre) + centre + shift), now.scale * factor
    )


def _rescaled(now: Similarity, scale: float, centre: Float) -> Similarity:
    R, t = now.T_target_source[:3, :3], now.T_target_source[:3, 3]
    return Similarity(pose(R, centre + scale / now.scale * (t - centre)), scale)
