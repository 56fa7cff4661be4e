"""How closely a fitted source lies on a target, and which directions that determines."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.alignment.settings import AlignmentSettings
from executive_plugins.alignment.surface import HOLDS, Surface

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid
from executive.messages.alignment import Uncertainty

# Root mean square distance to the nearest of points on a square grid, in its edge: 1 / sqrt(6).
_DENSE = 0.4
_PATCH_M = 0.25  # edge of the patches whose points are one observation
_LEAST_STD_M = 0.005  # of residuals across the surface
_WEAK = 4.0  # standard deviation of a weak direction, in that of the best determined one


@dataclass(frozen=True, slots=True, eq=False)
class Closeness:
    """Offsets of source points that overlap with the target within the gate's distance.

    Attributes:
        rmse_m: Root mean square distance to the nearest target point, of those that have one [m].
        judged_m: The same without what the distance of the target's points explains [m].
        dense_m: The same as if the target were as dense as the grid [m].
        overlap: Share of the source's points that have a target point, or lie on a plane of it.
        points: These source points, in the target's frame [m], shape (N, 3).
        normals: Of the target's surface there, shape (N, 3).
        across_m: Root mean square distance across the surface, of all that overlap [m].
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
    surface: Surface,
    source: Float,
    grid_m: float,
    settings: AlignmentSettings,
) -> Closeness:
    """Compare a source, thinned to a grid, with the target and its surface.

    The distance to the nearest target point has a part across the surface, and one along it, which
    is as large as the gaps between the target's points. Of the latter, what points as far apart as
    their planes hold have anyhow is not held against the fit; with `discount_gaps` none is beyond
    what a target as dense as the grid would have. A source point farther from the target's points
    overlaps with it as well if it lies on a plane of theirs, as between two lines of a lidar.
    """
    gate_m = settings.gate_distance_m
    distances, rows = PointGrid(target, settings.voxel_m).nearest(source, gate_m)
    is_near = np.isfinite(distances)
    near = source[is_near]
    if not len(near):
        none = np.empty((0, 3))
        return Closeness(gate_m, gate_m, gate_m, 0.0, none, none, gate_m, grid_m)
    feet = target.take(rows[is_near], axis=0)
    normals, radii_m = surface.planes(surface.nearest(feet))
    across = np.einsum("ij,ij->i", near - feet, normals)
    square, square_across = float(np.mean(distances[is_near] ** 2)), float(np.mean(across**2))
    along, dense = max(square - square_across, 0.0), (_DENSE * settings.voxel_m) ** 2
    gaps = max(float(np.mean((_DENSE * HOLDS * radii_m) ** 2)) - dense, 0.0)
    between, faces, across_between = _between_lines(surface, source[~is_near], gate_m)
    return Closeness(
        float(np.sqrt(square)),
        float(np.sqrt(square_across + max(along - gaps, min(along, dense)))),
        float(np.sqrt(square_across + min(along, dense))),
        (len(near) + len(between)) / len(source),
        np.vstack([near, between]),
        np.vstack([normals, faces]),
        float(np.sqrt(np.mean(np.append(across, across_between) ** 2))),
        grid_m,
    )


def _between_lines(surface: Surface, points: Float, gate_m: float) -> tuple[Float, Float, Float]:
    """Return the points that lie on a plane of the surface, its normals there, and their distances
    across [m].
    """
    distances, rows = surface.within(points, surface.near_m)
    met = np.flatnonzero(rows < len(surface))
    rows, points = rows.take(met), points.take(met, axis=0)
    normals, radii_m = surface.planes(rows)
    across = np.einsum("ij,ij->i", points - surface.points.take(rows, axis=0), normals)
    is_on = (distances.take(met) < HOLDS * radii_m) & (np.abs(across) < gate_m)
    on = np.flatnonzero(is_on)
    return points.take(on, axis=0), normals.take(on, axis=0), across.take(on)


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
