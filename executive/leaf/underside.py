"""The underside of a held stone: what is seen of it from below, in place of what was guessed."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, Int

_CELL_M = 0.05  # edge of the cells in which returns are averaged
_FEW = 3  # returns that make a cell: the range of one alone errs by centimetres
_COLUMN_M = 0.1  # edge of the columns of which the share that was seen is told
_BESIDE_M = 0.15  # aside from a seen part of the lower half, over which it tells where the air ends
_DEEP_M = 0.03  # below it from which on a point is in the air: three deviations of such a mean
_NEAR_M = 0.3  # from the model: what is farther away is not of the stone


@dataclass(frozen=True, slots=True, eq=False)
class Underside:
    """A stone's surface with what was seen of its lower half.

    Attributes:
        points: The surface, in the frame of the model [m], shape (N, 3).
        seen: Share of the columns of 0.1 m through the model in which its lower half was seen.
        raised_m: By how much the lowest point is higher than that of the model [m].
    """

    points: Float
    seen: float
    raised_m: float


def with_underside(model: Float, view: Float) -> Underside:
    """Return a model of which the lower half is what a view shows.

    The model of a stone that was seen on the ground ends in its sides, and in points of the ground
    around its foot. Points of it that are below what was seen of the stone hang in the air, and are
    left out. Where nothing was seen the model stays as it is.

    Args:
        model: The known surface, with z up as the stone lies [m], shape (N, 3).
        view: Returns of the stone, in the same frame [m], shape (M, 3).
    """
    from scipy.spatial import cKDTree  # reading a mission imports no algorithm

    lowest_m = float(model[:, 2].min())
    middle_m = lowest_m + 0.5 * float(np.ptp(model[:, 2]))
    away = cKDTree(model).query(view, distance_upper_bound=_NEAR_M)[0]
    seen = _averaged(view[np.isfinite(away) & (view[:, 2] < middle_m)])
    points = np.concatenate([model[~_is_in_the_air(model, seen)], seen])
    columns, known = _columns(model), _columns(seen)
    share = len(columns & known) / len(columns)
    return Underside(points, share, float(points[:, 2].min()) - lowest_m)


def _averaged(points: Float) -> Float:
    """Return the means of points (N, 3) in the cells that hold a few, shape (C, 3)."""
    _, which, counts = np.unique(
        _cells(points, _CELL_M), axis=0, return_inverse=True, return_counts=True
    )
    sums = np.zeros((len(counts), 3))
    np.add.at(sums, which.reshape(-1), points)
    return np.asarray((sums / counts[:, None])[counts >= _FEW])


def _is_in_the_air(points: Float, seen: Float) -> Bool:
    """Return which points (N, 3) are below all that was seen near by, shape (N,)."""
    from scipy.spatial import cKDTree

    if not len(seen):
        return np.zeros(len(points), dtype=bool)
    near = cKDTree(seen[:, :2]).query_ball_point(points[:, :2], _BESIDE_M)
    lowest = [seen[some, 2].min() if some else -np.inf for some in near]
    return np.asarray(points[:, 2] < np.array(lowest) - _DEEP_M)


def _columns(points: Float) -> set[tuple[int, ...]]:
    return {tuple(one) for one in _cells(points[:, :2], _COLUMN_M).tolist()}


def _cells(points: Float, edge_m: float) -> Int:
    return np.floor(points / edge_m).astype(np.int64)
