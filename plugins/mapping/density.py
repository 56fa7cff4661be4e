"""Density of a cloud over a sector of the ground."""

import numpy as np

from executive.arrays import Bool, Float, Int
from executive.errors import DataError
from executive.messages.sector import Sector


def dense_share(points_map: Float, sector: Sector, points_per_m2: float) -> float:
    """Return the share of a sector's cells of 1 m x 1 m that hold at least `points_per_m2` points.

    The cells form a grid along the axes of the map, with a corner at the sector's centre. A cell
    belongs to the sector if its middle does.

    Args:
        points_map: Points in the map [m], shape (N, 2) or (N, 3).
        sector: The part of the ground.
        points_per_m2: Number of points from which a cell counts as dense [1/m²].

    Raises:
        DataError: If the sector is so small that it holds the middle of no cell.
    """
    places = points_map[:, :2] - sector.centre_map
    reach = reach_of(sector)
    inside = (np.abs(places) < reach).all(axis=1)
    cells = np.floor(places[inside]).astype(np.int64) + reach
    counts = np.bincount(cells[:, 0] * 2 * reach + cells[:, 1], minlength=(2 * reach) ** 2)
    return share_of(counts.reshape(2 * reach, 2 * reach), sector, points_per_m2)


def reach_of(sector: Sector) -> int:
    """Return half the side of the square of cells about a sector's centre [m]."""
    return int(np.ceil(sector.farthest_m))


def share_of(counts: Int, sector: Sector, points_per_m2: float) -> float:
    """Return the same share from the number of points in each cell, shape (2 reach, 2 reach).

    Raises:
        DataError: If the sector is so small that it holds the middle of no cell.
    """
    reach = reach_of(sector)
    middles: Float = (
        np.indices((2 * reach, 2 * reach), dtype=np.float64).reshape(2, -1).T + 0.5 - reach
    )
    is_in_sector = _is_in_sector(middles, sector)
    if not is_in_sector.any():
        raise DataError(
            f"a sector of {sector.angle_rad:.2f} rad from {sector.nearest_m:.1f} m to "
            f"{sector.farthest_m:.1f} m holds no square metre whose density could be counted: "
            "choose a larger one"
        )
    return float((counts.ravel()[is_in_sector] >= points_per_m2).mean())


def _is_in_sector(places: Float, sector: Sector) -> Bool:
    """Return which places (M, 2), relative to the sector's centre, lie in it."""
    distances = np.hypot(places[:, 0], places[:, 1])
    aside = np.arctan2(places[:, 1], places[:, 0]) - sector.heading_rad
    turned = np.abs((aside + np.pi) % (2 * np.pi) - np.pi)
    is_near = (distances > sector.nearest_m) & (distances < sector.farthest_m)
    return np.asarray(is_near & (turned < sector.angle_rad / 2))
