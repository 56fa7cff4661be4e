"""The share of a sector's square metres that a cloud covers densely."""

import numpy as np
import pytest
from executive_plugins.mapping.density import dense_share

from executive.arrays import Float
from executive.errors import DataError
from executive.messages.sector import Sector


def grid(x: tuple[float, float], y: tuple[float, float], step_m: float = 0.1) -> Float:
    """Ground points in the middles of a grid's cells: 100 on a square metre at 0.1 m."""
    xs, ys = (np.arange(low, high, step_m) + step_m / 2 for low, high in (x, y))
    places = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    return np.column_stack([places, np.zeros(len(places))])


def test_cells_are_counted_one_by_one() -> None:
    """Of the half plane's 2 x 1 cells in a sector one is dense: the other's points do not help."""
    points = np.vstack([grid((0, 1), (0, 1)), grid((0, 1), (-1, 0), 0.05)[:399]])
    right = Sector(np.zeros(2), 0.0, np.pi, 0.0, 1.0)
    assert dense_share(points, right, 100.0) == 1.0
    assert dense_share(points, right, 101.0) == 0.5
    assert dense_share(points, right, 400.0) == 0.0


@pytest.mark.parametrize("heading_rad", [0.0, 1.2, -2.5, np.pi, 7.0])
def test_the_sector_follows_the_heading_across_the_half_turn(heading_rad: float) -> None:
    everywhere = grid((-9, 9), (-9, 9), 0.2)
    aside = np.arctan2(everywhere[:, 1], everywhere[:, 0]) - heading_rad
    ahead = everywhere[np.cos(aside) > 0]
    sector = Sector(np.zeros(2), heading_rad, 1.5, 3.0, 8.0)
    behind = Sector(np.zeros(2), heading_rad + np.pi, 1.5, 3.0, 8.0)
    assert dense_share(ahead, sector, 20.0) == 1.0
    assert dense_share(ahead, behind, 20.0) == 0.0


def test_the_share_moves_with_the_centre() -> None:
    points, centre = grid((0, 6), (-6, 6)), np.array([40.25, -17.5])
    sector = Sector(np.zeros(2), 0.4, 2.0, 1.0, 6.0)
    moved = Sector(centre, 0.4, 2.0, 1.0, 6.0)
    assert dense_share(points + [*centre, 3.0], moved, 90.0) == dense_share(points, sector, 90.0)


def test_cells_nearer_or_farther_than_the_ring_do_not_count() -> None:
    sector = Sector(np.zeros(2), 0.0, 2 * np.pi, 3.0, 6.0)
    assert dense_share(grid((-2, 2), (-2, 2)), sector, 1.0) == 0.0
    assert dense_share(grid((7, 9), (-9, 9)), sector, 1.0) == 0.0


def test_an_empty_cloud_is_nowhere_dense() -> None:
    assert dense_share(np.empty((0, 3)), Sector(np.zeros(2), 0.0, 2.0, 1.0, 6.0), 1.0) == 0.0


def test_impossible_sectors_are_refused() -> None:
    with pytest.raises(DataError, match="outer radius"):
        Sector(np.zeros(2), 0.0, 1.0, 6.0, 3.0)
    with pytest.raises(DataError, match="angle"):
        Sector(np.zeros(2), 0.0, 0.0, 1.0, 3.0)
