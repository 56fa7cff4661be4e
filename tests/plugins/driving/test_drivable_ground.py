"""Which ground is seen, how high it is, and what stands on it, on clouds of one point a cell."""

import numpy as np
import pytest
from executive_plugins.driving.drivable_ground import DrivableGround
from executive_plugins.driving.settings import GroundSettings

from executive.arrays import Float

CELL_M, STEP_M = 0.5, 0.25
AROUND = np.array([-5.0, -5.0]), np.array([5.0, 5.0])


def ground(points: Float, **settings: float) -> DrivableGround:
    made = GroundSettings.model_validate({"cell_m": CELL_M, **settings})
    return DrivableGround(np.array(points), AROUND, STEP_M, made)


def cells(slope: float = 0.0) -> Float:
    """Return a point in the middle of each cell of the area [m], shape (N, 3)."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(-5.0, 5.1, CELL_M)] * 2))
    return np.column_stack([x, y, slope * x])


def raised(low: float, high: float, height_m: float, slope: float = 0.0) -> Float:
    """Return the same with a block on the square between two places."""
    points = cells(slope)
    is_on = ((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1)
    return points + np.outer(is_on, [0.0, 0.0, height_m])


@pytest.mark.parametrize("beside_m", [0.0, 0.5, 1.0])
def test_ground_so_near_to_seen_ground_counts_as_seen(beside_m: float) -> None:
    seen = ground([[1.0, -1.0, 0.0]], beside_m=beside_m)
    away = np.arange(0.0, 2.1, CELL_M)
    for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        places = [1.0, -1.0] + away[:, None] * (x, y)
        np.testing.assert_array_equal(seen.is_seen(places), away <= beside_m)


def test_without_a_point_nothing_is_seen_or_known_but_what_is_vouched_for() -> None:
    bare = ground(np.zeros((0, 3)))
    places = np.array([[0.0, 0.0], [0.9, 0.0], [1.6, 0.0], [0.0, -0.9]])
    assert not bare.is_seen(places).any()
    assert np.isnan(bare.heights(places)).all()
    assert len(bare.obstacles_map) == 0
    bare.vouch(np.zeros(2), 1.0)
    np.testing.assert_array_equal(bare.is_seen(places), [True, True, False, True])
    assert np.isnan(bare.heights(places)).all()


def test_a_place_beyond_the_area_is_not_seen() -> None:
    level = ground(cells())
    places = np.array([[5.0, 0.0], [5.4, 0.0], [5.6, 0.0], [0.0, -5.6], [-9.0, 9.0]])
    np.testing.assert_array_equal(level.is_seen(places), [True, True, False, False, False])


def test_points_beyond_the_area_do_not_count() -> None:
    outside = [[6.0, 0.0, 9.0], [0.0, -5.3, 9.0]]
    level = ground(np.vstack([cells(), outside]))
    assert len(level.obstacles_map) == 0


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_a_slope_is_ground_as_it_is(slope: float) -> None:
    """But for the rim of the area, within the opening's half width of 1.5 m."""
    found = ground(cells(slope))
    places = np.array([[0.0, 0.0], [2.0, -3.0], [-4.0, 1.0]])
    np.testing.assert_allclose(found.heights(places), slope * places[:, 0], atol=1e-9)
    assert not (found.obstacles_map[:, 0] < 3.5).any()


def test_what_is_narrower_than_the_widest_object_is_no_ground() -> None:
    """Five cells of half a metre, of which a block is two wide or six wide."""
    narrow = ground(raised(-0.5, 0.5, 1.0), widest_object_m=2.0)
    np.testing.assert_allclose(narrow.heights(np.zeros((1, 2))), [0.0])
    assert len(narrow.obstacles_map) == 9
    assert (narrow.obstacles_map[:, 2] == 1.0).all()
    wide = ground(raised(-1.5, 1.5, 1.0), widest_object_m=2.0)
    np.testing.assert_allclose(wide.heights(np.zeros((1, 2))), [1.0])
    assert len(wide.obstacles_map) == 0


@pytest.mark.parametrize(("height_m", "stands"), [(0.2, False), (0.3, True)])
def test_what_is_no_higher_than_a_step_is_driven_over(height_m: float, stands: bool) -> None:
    found = ground(raised(0.0, 0.0, height_m), widest_object_m=2.0)
    assert (len(found.obstacles_map) == 1) is stands


def test_of_points_above_one_another_the_lowest_is_ground() -> None:
    found = ground(np.vstack([cells(), [[1.0, 1.0, 0.7], [1.0, 1.0, 0.1]]]))
    np.testing.assert_allclose(found.heights(np.array([[1.0, 1.0]])), [0.0])
    np.testing.assert_array_equal(found.obstacles_map, [[1.0, 1.0, 0.7]])
