"""The height map and the ground below it."""

import numpy as np

from executive.arrays import Float
from plugins.motion.obstacles import Obstacles


def site() -> Float:
    """Level ground at −1 m, and a cube of 1 m that stands on it at x = 5 m; its underside is not seen."""
    x, y = np.meshgrid(np.arange(-8, 8, 0.05), np.arange(-8, 8, 0.05))
    z = np.where((np.abs(x - 5) < 0.5) & (np.abs(y) < 0.5), 0.0, -1.0)
    return np.c_[x.ravel(), y.ravel(), z.ravel()]


def test_tells_the_height_above_the_highest_point_nearby() -> None:
    heights = Obstacles(site(), 11.0).clearances(np.array([[5.0, 0.0, 0.7], [0.0, 3.0, 0.7], [30.0, 30.0, 5.0]]))
    np.testing.assert_allclose(heights[:2], [0.7, 1.7], atol=1e-9)
    assert heights[2] > 100


def test_finds_the_highest_point_of_a_sector_only() -> None:
    obstacles = Obstacles(site(), 11.0)
    assert obstacles.highest((-0.3, 0.3), (4.0, 6.0)) == 0.0
    assert obstacles.highest((0.5, 3.0), (4.0, 6.0)) == -1.0
    assert obstacles.highest((-0.3, 0.3), (1.0, 3.0)) == -1.0
    assert obstacles.highest((-0.3, 0.3), (20.0, 30.0)) < -100


def test_the_ground_is_solid_and_a_stone_is_not_ground() -> None:
    obstacles = Obstacles(site(), 11.0)
    depths = obstacles.depths_in_ground(np.array([[0.0, 3.0, -1.4], [4.4, 0.0, -0.5], [0.0, 3.0, -0.9]]))
    np.testing.assert_allclose(depths, [0.4, -0.5, -0.1], atol=1e-9)
    found = obstacles.points[obstacles.in_box(np.array([4.0, -1.0, -2.0]), np.array([6.0, 1.0, 2.0]))]
    assert len(found)
    assert (found[:, 2] == 0.0).all()


def test_nothing_around_is_no_obstacle() -> None:
    empty = Obstacles(np.zeros((0, 3)), 11.0)
    assert empty.clearances(np.zeros((1, 3)))[0] > 100
    assert empty.depths_in_ground(np.zeros((1, 3)))[0] < -100
