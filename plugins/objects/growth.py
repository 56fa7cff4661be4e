"""Whether a view fits the model of a stone, and the model after merging it."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.objects.surface import box_centre, diagonal_m
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.voxels import voxel_means

_ITERATIONS = 20
_COARSER = 1.26  # doubles the volume of a cell


@dataclass(frozen=True, slots=True)
class Fit:
    """How well a view fits a model.

    Attributes:
        share: Share of the points of one that are near the other; the larger of both directions,
            since a partial view lies wholly on the whole stone, but not vice versa.
        rmse_m: Root mean square distance of those points [m].
        growth: Box diagonal of both together over that of the model.
    """

    share: float
    rmse_m: float
    growth: float

    def __str__(self) -> str:
        return (
            f"overlap {self.share:.2f}, rmse {100 * self.rmse_m:.1f} cm, growth {self.growth:.2f}"
        )


def fit_of(model: Float, view: Float, distance_m: float) -> Fit:
    """Compare a view (M, 3) with a model (N, 3) in one frame [m]; nearer than a distance counts."""
    directions = []
    for surface, points in ((model, view), (view, model)):
        distances = cKDTree(surface).query(points, distance_upper_bound=distance_m)[0]
        near = distances[np.isfinite(distances)]
        rmse_m = float(np.sqrt(np.mean(near**2))) if len(near) else distance_m
        directions.append((len(near) / len(distances), rmse_m))
    share, rmse_m = max(directions, key=lambda direction: direction[0])
    growth = diagonal_m(np.vstack([model, view])) / max(diagonal_m(model), 1e-9)
    return Fit(share, rmse_m, growth)


def shifts_of(model: Float, view: Float, voxel_m: float) -> tuple[Float, Float]:
    """Return two estimates of the shift of a view from a model [m]: by means and by box centres.

    The means are those of thinned clouds. Both estimates are biased for a view from one side.
    """
    even = voxel_means(view, voxel_m)
    return even.mean(axis=0) - model.mean(axis=0), box_centre(even) - box_centre(model)


def icp_shift(model: Float, view: Float, distance_m: float) -> Float:
    """Return the shift of a view from a model by ICP without rotation [m], shape (3,).

    It suits a view from one side that is close to the model, for which mean and box are biased
    (ICP: Besl 1992).

    Args:
        model, view: Shapes (N, 3), (M, 3), in one frame [m].
        distance_m: Pairs of points farther apart are ignored.
    """
    shift, surface = np.zeros(3), cKDTree(model)
    for _ in range(_ITERATIONS):
        moved = view - shift
        distances, nearest = surface.query(moved, distance_upper_bound=distance_m)
        is_near = np.isfinite(distances)
        if not is_near.any():
            break
        shift += (moved[is_near] - model[nearest[is_near]]).mean(axis=0)
    return shift


def merged(model: Float, view: Float, voxel_m: float, most: int) -> Float:
    """Return a model with the new points of a view, thinned to at most `most` points.

    Points farther than a cell from the model are new. The others are not added: their noise would
    thicken the surface with each view. The grid is made coarser while there are too many points.
    """
    new = (
        view[~np.isfinite(cKDTree(model).query(view, distance_upper_bound=voxel_m)[0])]
        if len(model)
        else view
    )
    points = np.vstack([model, voxel_means(new, voxel_m)])
    while len(points) > most:
        voxel_m *= _COARSER
        points = voxel_means(points, voxel_m)
    return points
