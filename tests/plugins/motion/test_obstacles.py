"""The height map and the ground below it."""

import numpy as np
import pytest
from executive_plugins.motion.obstacles import Obstacles

from executive.arrays import Float


def site() -> Float:
    """Level ground at −1 m, and a cube of 1 m that stands on it at x = 5 m; its underside is not
    seen.
    """
    x, y = np.meshgrid(np.arange(-8, 8, 0.05), np.arange(-8, 8, 0.05))
    z = np.where((np.abs(x - 5) < 0.5) & (np.abs(y) < 0.5), 0.0, -1.0)
    return np.c_[x.ravel(), y.ravel(), z.ravel()]


def test_tells_the_height_above_the_highest_point_nearby() -> None:
    heights = Obstacles(site(), 11.0).clearances(
        np.array([[5.0, 0.0, 0.7], [0.0, 3.0, 0.7], [30.0, 30.0, 5.0]])
    )
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
    depths = obstacles.depths_in_ground(
        np.array([[0.0, 3.0, -1.4], [4.4, 0.0, -0.5], [0.0, 3.0, -0.9]])
    )
    np.testing.assert_allclose(depths, [0.4, -0.5, -0.1], atol=0.01)
    found = obstacles.points[
        obstacles.in_box(np.array([4.0, -1.0, -2.0]), np.array([6.0, 1.0, 2.0]))
    ]
    assert len(found)
    assert (found[:, 2] == 0.0).all()


def test_nothing_around_is_no_obstacle() -> None:
    empty = Obstacles(np.zeros((0, 3)), 11.0)
    assert empty.clearances(np.zeros((1, 3)))[0] > 100
    assert empty.depths_in_ground(np.zeros((1, 3)))[0] < -100


SUN = np.array(
    [1.0, 0.0, -0.5]
)  # rays of a lidar far behind the stone's near side: a shadow twice its height


def shadowed(slope: float) -> Float:
    """Ground that rises along y, and a cube of 1 m at x = 5 m whose far side and shadow the lidar
    does not see.
    """
    x, y = np.meshgrid(np.arange(-8, 8, 0.05), np.arange(-8, 8, 0.05))
    is_stone = (np.abs(x - 5) < 0.5) & (np.abs(y) < 0.5)
    is_dark = (x >= 5.5) & (x < 5.5 + 1.0 / -SUN[2]) & (np.abs(y) < 0.5)
    ground = np.c_[x.ravel(), y.ravel(), (slope * y - 1.0).ravel()][~(is_stone | is_dark).ravel()]
    top = np.c_[x[is_stone], y[is_stone], np.zeros(is_stone.sum()) + slope * y[is_stone]]
    far_edge = np.c_[
        np.full(20, 5.5), np.linspace(-0.5, 0.5, 20), np.linspace(-0.5, 0.5, 20) * slope - 0.6
    ]
    return np.vstack([ground, top, far_edge])


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_in_a_stone_s_shadow_the_stone_is_not_the_ground(slope: float) -> None:
    obstacles = Obstacles(shadowed(slope), 11.0)
    beside = np.array(
        [[5.6, y, slope * y - 0.85] for y in (-0.2, 0.0, 0.2)]
    )  # 15 cm above the ground that is not seen
    np.testing.assert_allclose(obstacles.depths_in_ground(beside), -0.15, atol=0.03)
    assert not obstacles.is_ground[
        np.abs(obstacles.points[:, 2] - slope * obstacles.points[:, 1] + 0.6) < 1e-6
    ].any()


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_the_ground_in_a_shadow_is_as_solid_as_that_beside_it(slope: float) -> None:
    obstacles = Obstacles(shadowed(slope), 11.0)
    buried = np.array([[6.5, 0.2, 0.2 * slope - 1.2]])
    np.testing.assert_allclose(obstacles.depths_in_ground(buried), 0.2, atol=0.03)
    assert obstacles.clearances(buried)[0] < 0.0


def test_on_a_slope_the_ground_lies_where_it_is_seen() -> None:
    x, y = np.meshgrid(np.arange(-8, 8, 0.05), np.arange(-8, 8, 0.05))
    points = np.c_[x.ravel(), y.ravel(), (0.4 * x - 0.2 * y).ravel()]
    probes = np.random.default_rng(0).uniform(-6, 6, (200, 3))
    depth = 0.4 * probes[:, 0] - 0.2 * probes[:, 1] - probes[:, 2]
    np.testing.assert_allclose(Obstacles(points, 11.0).depths_in_ground(probes), depth, atol=0.05)


def test_waves_of_the_ground_are_ground() -> None:
    x, y = np.meshgrid(np.arange(-8, 8, 0.05), np.arange(-8, 8, 0.05))
    waves = 0.2 * np.sin(2 * np.pi * x / 6.0) * np.cos(2 * np.pi * y / 8.0)
    obstacles = Obstacles(np.c_[x.ravel(), y.ravel(), waves.ravel()], 11.0)
    is_inside = (np.abs(obstacles.points[:, :2]) < 6.0).all(
        axis=1
    )  # a metre or two from the edge of what is seen
    assert obstacles.is_ground[is_inside].all()
    assert obstacles.depths_in_ground(obstacles.points[is_inside]).max() < 0.03


def test_a_thin_slab_without_ground_under_it_does_not_raise_the_ground() -> None:
    """Its points lie within the roughness of the ground, whose lowest points are beside it."""
    points = site()
    on_slab = (np.abs(points[:, 0]) < 0.16) & (np.abs(points[:, 1] - 3.0) < 0.16)
    points[on_slab, 2] += 0.05
    depth = Obstacles(points, 11.0).depths_in_ground(np.array([[0.0, 3.0, -1.0]]))
    np.testing.assert_allclose(depth, 0.0, atol=0.01)
