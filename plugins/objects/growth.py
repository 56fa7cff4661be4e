"""Whether a view belongs to a stone's model, and what the model is afterwards."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.objects.surface import box_centre, diagonal_m
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.voxels import voxel_means

_DRAWS = 20
_COARSER = 1.26  # twice the volume of a cell


@dataclass(frozen=True, slots=True)
class Fit:
    """How a view lies on a model.

    Attributes:
        share: Share of one's points that are near the other, of the two shares the larger: a
            half-seen stone lies wholly on the whole stone, but not vice versa.
        rmse_m: Root mean square distance of those points [m].
        growth: Diagonal of both together over the model's.
    """

    share: float
    rmse_m: float
    growth: float

    def __str__(self) -> str:
        return (
            f"overlap {self.share:.2f}, rmse {100 * self.rmse_m:.1f} cm, growth {self.growth:.2f}"
        )


def fit_of(model: Float, view: Float, distance_m: float) -> Fit:
    """Measure a view (M, 3) against a model (N, 3), both in one frame [m]; points count as near up
    to a distance.
    """
    ways = []
    for surface, points in ((model, view), (view, model)):
        distances = cKDTree(surface).query(points, distance_upper_bound=distance_m)[0]
        near = distances[np.isfinite(distances)]
        rmse_m = float(np.sqrt(np.mean(near**2))) if len(near) else distance_m
        ways.append((len(near) / len(distances), rmse_m))
    share, rmse_m = max(ways, key=lambda way: way[0])
    growth = diagonal_m(np.vstack([model, view])) / max(diagonal_m(model), 1e-9)
    return Fit(share, rmse_m, growth)


def shifts_of(model: Float, view: Float, voxel_m: float) -> tuple[Float, Float]:
    """Return how far a view may have moved from a model without turning [m]: by their means, by
    their boxes' middles.

    Means of an even density; those of a view from one side are off, and so may the boxes be.
    """
    even = voxel_means(view, voxel_m)
    return even.mean(axis=0) - model.mean(axis=0), box_centre(even) - box_centre(model)


def drawn_shift(model: Float, view: Float, distance_m: float) -> Float:
    """Return the shift of a view from a model that its points' nearest neighbours draw it by [m],
    shape (3,).

    ICP without turning (Besl 1992), for a view from one side that lies near: its mean and its box
    tell little.

    Args:
        model, view: Shapes (N, 3), (M, 3), in one frame [m].
        distance_m: Neighbours farther off draw nothing.
    """
    shift, surface = np.zeros(3), cKDTree(model)
    for _ in range(_DRAWS):
        moved = view - shift
        distances, nearest = surface.query(moved, distance_upper_bound=distance_m)
        is_near = np.isfinite(distances)
        if not is_near.any():
            break
        shift += (moved[is_near] - model[nearest[is_near]]).mean(axis=0)
    return shift


def merged(model: Float, view: Float, voxel_m: float, most: int) -> Float:
    """Return a model with what a view shows anew, on a grid, coarser where it would hold too many
    points.

    New is what lies farther than a cell from the model. The rest is known: added, it would thicken
    the surface with each view, for noise reaches into the next cell.
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
