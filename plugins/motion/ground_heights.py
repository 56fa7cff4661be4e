"""Heights of the ground over an area, also under stones: local planes through the lowest points."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from executive.arrays import Float

_CELL_M = 0.3  # edge of the cells whose lowest points are used
# Widths of the neighbourhoods, pass by pass; wide ones reach beyond a stone.
_WIDTHS_M = (2.0, 2.0, 1.0, 1.0, 0.6, 0.6)
_ABOVE_M = 0.08  # height above the surface at which the weight of a cell is a quarter
_LEAST_SUPPORT = 0.03  # least weighted share of a neighbourhood that must be seen
_LEAST_SPREAD_M = 0.1  # regularises the slope of planes through points that are close together


@dataclass(frozen=True, slots=True, eq=False)
class _Lowest:
    """The lowest point of each cell of a square grid, arrays of shape (n, n).

    Where a cell has no point, `is_seen` is 0.
    """

    is_seen: Float
    x: Float
    y: Float
    z: Float
    centres_m: Float  # cell centres along an axis, shape (n,)


def ground_heights(points: Float, centres_m: Float) -> Float:
    """Return the ground height at (centres[i], centres[j]) [m], shape (n, n); NaN if unknown.

    A plane is fitted around each cell to the lowest points of the cells around it. Points above it
    (stones) get a smaller weight in the next of six passes; the first passes use wide
    neighbourhoods. A stone is therefore not taken for ground even if nothing lower is seen in its
    shadow, and slopes are kept. At a step of the ground, the upper side counts as a stone for about
    a metre.

    Args:
        points: Ground and objects on it, z up [m], shape (N, 3).
        centres_m: Rising, evenly spaced coordinates, the same along x and y, shape (n,).
    """
    if not len(points):
        return np.full((len(centres_m), len(centres_m)), np.nan)
    low = _lowest(points, float(np.abs(centres_m).max()))
    weight, surface = low.is_seen, np.full_like(low.z, np.nan)
    for width_m in _WIDTHS_M:
        fitted = _local_planes(low, weight, width_m / _CELL_M)
        surface = np.where(np.isnan(fitted), surface, fitted)
        above = np.maximum(low.z - surface, 0.0) / _ABOVE_M
        weight = np.where(low.is_seen > 0, 1.0 / (1.0 + np.nan_to_num(above) ** 2) ** 2, 0.0)
    at = (centres_m - low.centres_m[0]) / _CELL_M
    return np.asarray(
        map_coordinates(surface, np.meshgrid(at, at, indexing="ij"), order=1, mode="nearest")
    )


def _local_planes(low: _Lowest, weight: Float, width_cells: float) -> Float:
    """Return the height of a weighted plane around each cell, at its centre, (n, n).

    It is NaN where the support is too small.
    """

    def blurred(values: Float) -> Float:
        """Return the fields, shape (..., n, n), each blurred by itself."""
        widths = (0.0,) * (values.ndim - 2) + (width_cells,) * 2
        return np.asarray(gaussian_filter(values, widths, mode="constant", truncate=3.0))

    support = blurred(weight)
    is_known = support >= _LEAST_SUPPORT
    support = np.where(is_known, support, np.nan)
    x, y, z = low.x, low.y, low.z
    fields = np.stack([x, y, z, x * x, y * y, x * y, x * z, y * z])
    x, y, z, xx, yy, xy, xz, yz = blurred(weight * fields) / support
    xx, yy, xy, xz, yz = xx - x**2, yy - y**2, xy - x * y, xz - x * z, yz - y * z
    xx, yy = xx + _LEAST_SPREAD_M**2, yy + _LEAST_SPREAD_M**2
    determinant = xx * yy - xy**2
    slope_x, slope_y = (yy * xz - xy * yz) / determinant, (xx * yz - xy * xz) / determinant
    at_x, at_y = np.meshgrid(low.centres_m, low.centres_m, indexing="ij")
    return np.asarray(z + slope_x * (at_x - x) + slope_y * (at_y - y))


def _lowest(points: Float, half_m: float) -> _Lowest:
    n = 2 * int(np.ceil(half_m / _CELL_M)) + 1
    centres = np.asarray((np.arange(n) - n // 2) * _CELL_M, dtype=np.float64)
    column, row = np.clip(np.rint(points[:, :2].T / _CELL_M).astype(np.int64) + n // 2, 0, n - 1)
    cell = column * n + row
    lowest = np.full(n * n, np.inf)
    np.minimum.at(lowest, cell, points[:, 2])
    is_lowest = points[:, 2] == lowest[cell]
    filled = np.zeros((n * n, 4))
    filled[cell, 0] = 1.0
    filled[cell[is_lowest], 1:] = points[is_lowest]
    is_seen, x, y, z = filled.T.reshape(4, n, n)
    return _Lowest(is_seen, x, y, z, centres)
