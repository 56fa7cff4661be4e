"""A map of planes: no normals from rings, and no second scan from one place."""

import numpy as np
import pytest
from executive_plugins.odometry.plane_map import PlaneMap

from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis

UP = np.array([0.0, 0.0, 1.0])


def ground(rng: np.random.Generator) -> np.ndarray:
    return np.c_[rng.uniform(-3, 3, (4000, 2)), rng.normal(0, 0.01, 4000)]


def test_normals_of_ground_point_up_or_down() -> None:
    plane_map = PlaneMap(0.15, 0.45, 16, 10)
    plane_map.add(np.eye(4), ground(np.random.default_rng(0)))
    assert len(plane_map.planes.points) > 500
    assert np.median(np.abs(plane_map.planes.normals @ UP)) > 0.995


def test_a_ring_on_the_ground_gives_no_plane() -> None:
    angle = np.linspace(0, 2 * np.pi, 2000)
    ring = np.c_[
        8 * np.cos(angle), 8 * np.sin(angle), np.random.default_rng(1).normal(0, 0.02, 2000)
    ]
    plane_map = PlaneMap(0.15, 0.45, 16, 10)
    plane_map.add(np.eye(4), ring)
    assert len(plane_map.planes.points) == 0


def test_a_scan_is_new_where_none_was_taken() -> None:
    plane_map = PlaneMap(0.15, 0.45, 16, 10)
    points = ground(np.random.default_rng(2))
    plane_map.add(np.eye(4), points)
    assert not plane_map.is_new(pose(about_axis(UP, 0.05), np.array([0.1, 0, 0])), 0.5, 0.12)
    assert plane_map.is_new(pose(about_axis(UP, 0.2)), 0.5, 0.12)
    assert plane_map.is_new(pose(t=np.array([0.6, 0, 0])), 0.5, 0.12)


def test_what_lies_far_behind_is_forgotten() -> None:
    plane_map = PlaneMap(0.15, 0.45, 16, 3)
    points = ground(np.random.default_rng(3))
    for x in (0.0, 10.0, 20.0, 30.0):
        plane_map.add(pose(t=np.array([x, 0, 0])), points)
    assert plane_map.planes.points[:, 0].min() > 6
    assert plane_map.planes.points[:, 0].max() > 32


FAR = np.array([[50.0 + 2 * k, 0.0, 0.0] for k in range(6)])  # each alone


def hexagon(radius_m: float, bump_m: float = 0.0, corners: int = 6) -> np.ndarray:
    """Return a middle at (1, 2, 3) and corners about it, by turns above and below a level plane.

    Their variance is 3/7 of the squared radius along the plane, and 6/7 of that of the bumps
    across it.
    """
    angle = np.arange(corners) * np.pi / 3
    around = np.c_[radius_m * np.cos(angle), radius_m * np.sin(angle), bump_m * np.cos(3 * angle)]
    return np.array([1.0, 2.0, 3.0]) + np.vstack([np.zeros(3), around])


def planes_of(points: np.ndarray, neighbours: int = 16, T: np.ndarray | None = None) -> PlaneMap:
    plane_map = PlaneMap(0.02, 0.45, neighbours, 10)
    plane_map.add(np.eye(4) if T is None else T, np.vstack([points, FAR]))
    return plane_map


def test_a_plane_is_the_mean_of_a_point_and_its_neighbours_with_their_normal() -> None:
    """The corners have neighbours on one side only, fewer than a plane takes."""
    T = pose(about_axis(np.array([1.0, 0.0, 0.0]), 0.3), np.array([0.5, -1.0, 2.0]))
    found = planes_of(hexagon(0.3), T=T).planes
    assert found.points == pytest.approx(np.array([T[:3, :3] @ [1, 2, 3] + T[:3, 3]]), abs=1e-6)
    assert np.abs(found.normals @ T[:3, 2]) == pytest.approx([1.0], abs=1e-6)


def test_a_plane_takes_six_points() -> None:
    (five,) = planes_of(hexagon(0.3, corners=5)).planes.points
    assert five == pytest.approx(hexagon(0.3, corners=5).mean(axis=0), abs=1e-6)
    assert len(planes_of(hexagon(0.3, corners=4)).planes.points) == 0
    assert len(planes_of(hexagon(0.3), neighbours=6).planes.points) == 1
    assert len(planes_of(hexagon(0.3), neighbours=5).planes.points) == 0
    alone = PlaneMap(0.02, 0.45, 16, 10)
    alone.add(np.eye(4), hexagon(0.3, corners=5))  # without the far points: six in all
    assert len(alone.planes.points) == 1
    alone = PlaneMap(0.02, 0.45, 16, 10)
    alone.add(np.eye(4), hexagon(0.3, corners=4))
    assert (len(alone.planes.points), len(alone.planes.normals)) == (0, 0)


def test_a_plane_is_wider_than_a_ring_and_flat() -> None:
    """A sixth of the radius is 0.075 m; a standard deviation of that has a hexagon of 0.1146 m."""
    assert len(planes_of(hexagon(0.116)).planes.points) == 7  # each corner sees all others
    assert len(planes_of(hexagon(0.113)).planes.points) == 0
    assert len(planes_of(hexagon(0.3, bump_m=0.066)).planes.points) == 1
    assert len(planes_of(hexagon(0.3, bump_m=0.068)).planes.points) == 0


def test_points_find_the_nearest_plane_within_reach() -> None:
    plane_map = planes_of(np.vstack([hexagon(0.3), hexagon(0.3) + [5.0, 0.0, 0.0]]))
    order = np.argsort(plane_map.planes.points[:, 0])
    found, index = plane_map.nearest(
        np.array([[6.2, 2.0, 3.0], [1.0, 2.3, 3.0], [1.0, 2.0, 2.0], [1.0, 2.0, 3.1]]), 0.5
    )
    assert found.tolist() == [True, True, False, True]
    assert index.tolist() == [order[1], order[0], order[0]]


def test_a_map_without_planes_has_none_near_anything() -> None:
    empty = PlaneMap(0.15, 0.45, 16, 10)
    barren = PlaneMap(0.15, 0.45, 16, 10)
    barren.add(np.eye(4), FAR)
    for one in (empty, barren):
        found, index = one.nearest(np.zeros((3, 3)), 100.0)
        assert (found.tolist(), index.tolist()) == ([False] * 3, [])
        assert one.planes.points.shape == one.planes.normals.shape == (0, 3)
    assert empty.is_new(np.eye(4), 0.5, 0.1)


def at(x: float, turned_rad: float = 0.0) -> np.ndarray:
    return pose(about_axis(UP, turned_rad), np.array([x, 0.0, 0.0]))


def test_a_full_map_loses_the_scan_farthest_from_the_newest() -> None:
    """Of equally far ones it is the oldest, also if all were taken at one place."""
    plane_map = PlaneMap(0.15, 0.45, 16, 3)
    points = hexagon(0.3)
    for x in (0.0, -4.0, 2.0, 1.0):
        plane_map.add(at(x), points)
    kept = [x for x in (0.0, -4.0, 2.0, 1.0) if not plane_map.is_new(at(x), 0.5, 0.1)]
    assert kept == [0.0, 2.0, 1.0]
    plane_map.add(at(1.0, 0.5), points)  # 0 and 2 are one metre away each
    assert plane_map.is_new(at(0.0), 0.5, 0.1)
    assert not plane_map.is_new(at(2.0), 0.5, 0.1)
    turning = PlaneMap(0.15, 0.45, 16, 3)
    for turned_rad in (0.0, 0.5, 1.0, 1.5):
        turning.add(at(0.0, turned_rad), points)
    new = [turning.is_new(at(0.0, angle), 0.5, 0.1) for angle in (0.0, 0.5, 1.0, 1.5)]
    assert new == [True, False, False, False]


def test_a_place_is_near_within_both_bounds() -> None:
    plane_map = PlaneMap(0.15, 0.45, 16, 3)
    plane_map.add(at(1.0, 0.3), hexagon(0.3))
    assert not plane_map.is_new(at(1.499, 0.3), 0.5, 0.1)
    assert plane_map.is_new(at(1.5, 0.3), 0.5, 0.1)
    assert not plane_map.is_new(at(1.0, 0.399), 0.5, 0.1)
    assert plane_map.is_new(at(1.0, 0.401), 0.5, 0.1)
