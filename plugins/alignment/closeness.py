"""How closely a fitted source lies on a target, and which directions that determines."""

from dataclasses import dataclass

import numpy as np
import small_gicp
from executive_plugins.alignment.settings import AlignmentSettings

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid
from executive.messages.alignment import Uncertainty

# Root mean square distance to the nearest of points on a square grid, in its edge: 1 / sqrt(6).
_DENSE = 0.4
_PATCH_M = 0.25  # edge of the patches whose points are one observation
_CELL = 3.0  # edge of the cells in which points are looked up, in that of the thinning: fastest
_LEAST_STD_M = 0.005  # of residuals across the surface
_WEAK = 4.0  # standard deviation of a weak direction, in that of the best determined one


@dataclass(frozen=True, slots=True, eq=False)
class Closeness:
    """Offsets of source points that have a target point within the gate's distance.

    Attributes:
        rmse_m: Root mean square distance to the nearest target point [m].
        judged_m: The same without what the distance of the target's points explains [m].
        dense_m: The same as if the target were as dense as the grid [m].
        overlap: Share of the source's points that have a target.
        points: The source points that have one, in the target's frame [m], shape (N, 3).
        normals: Of the target's surface there, shape (N, 3).
        across_m: Root mean square distance across the surface [m].
        voxel_m: Grid to which the points are thinned [m].
    """

    rmse_m: float
    judged_m: float
    dense_m: float
    overlap: float
    points: Float
    normals: Float
    across_m: float
    voxel_m: float

    def uncertainty(self) -> Uncertainty | None:
        """Return the covariance that the Hessian of distances across the surface gives.

        None where the points are too few. Directions along which the surface may slide have a large
        variance.
        """
        count = len(self.points)
        if count < 6:
            return None
        centre = self.points.mean(axis=0)
        J = np.column_stack([np.cross(self.points - centre, self.normals), self.normals])
        per_patch = max((_PATCH_M / self.voxel_m) ** 2, 1.0)
        variance = max(self.across_m, _LEAST_STD_M) ** 2 * per_patch
        covariance = variance * np.linalg.inv(J.T @ J + 1e-6 * count * np.eye(6))
        return Uncertainty(0.5 * (covariance + covariance.T), centre)


def measure(
    target: Float,
    surface: small_gicp.PointCloud,
    source: Float,
    grid_m: float,
    settings: AlignmentSettings,
    apart_m: float = 0.0,
) -> Closeness:
    """Compare a source, thinned to a grid, with the target, whose normals are those of its surface.

    The distance to the nearest target point has a part across the surface, and one along it, which
    is as large as the gaps between the target's points. Of the latter, what points so far apart
    have anyhow is not held against the fit; with `discount_gaps` none is beyond what a target as
    dense as the grid would have.
    """
    thinned = small_gicp.voxelgrid_sampling(source, grid_m, 1).points()[:, :3]
    distances, rows = PointGrid(target, settings.voxel_m).nearest(thinned, settings.gate_distance_m)
    near = np.isfinite(distances)
    if not near.any():
        none = np.empty((0, 3))
        limit_m = settings.gate_distance_m
        return Closeness(limit_m, limit_m, limit_m, 0.0, none, none, limit_m, grid_m)
    feet = target.take(rows[near], axis=0)
    # The mean of the points in a cell is nearer to each of them than the cell's diagonal.
    even = PointGrid(np.array(surface.points()[:, :3]), _CELL * settings.voxel_m)
    nearest = even.nearest(feet, 2 * settings.voxel_m)[1]
    normals = surface.normals().take(nearest, axis=0)[:, :3].copy()
    across = np.einsum("ij,ij->i", thinned[near] - feet, normals)
    square = float(np.mean(distances[near] ** 2))
    square_across = float(np.mean(across**2))
    along, dense = max(square - square_across, 0.0), (_DENSE * settings.voxel_m) ** 2
    gaps = max((_DENSE * apart_m) ** 2 - dense, 0.0)
    return Closeness(
        float(np.sqrt(square)),
        float(np.sqrt(square_across + max(along - gaps, min(along, dense)))),
        float(np.sqrt(square_across + min(along, dense))),
        float(near.mean()),
        np.array(thinned[near]),
        normals,
        float(np.sqrt(square_across)),
        grid_m,
    )


def weak_direction(doubt: Uncertainty) -> str:
    """Say along which direction a motion is hardly determined; nothing if all are alike.

    The noise of normals makes every direction look determined a little, so directions are compared.
    """
    told = []
    for name, block, unit in (
        ("turning about", doubt.covariance[:3, :3], "rad"),
        ("sliding along", doubt.covariance[3:, 3:], "m"),
    ):
        variances, axes = np.linalg.eigh(block)
        weakest, best = np.sqrt(variances[-1]), np.sqrt(variances[0])
        if weakest > _WEAK * best:
            axis = axes[:, -1] * (1 if axes[np.abs(axes[:, -1]).argmax(), -1] > 0 else -1)
            words = ", ".join(f"{x:.2f}" for x in axis)
            told.append(
                f"; weak: {name} ({words}), {weakest / best:.0f} times as uncertain as across, "
                f"{weakest:.1g} {unit}"
            )
    return "".join(told)
