"""A map of planes: no normals from rings, and no second scan from one place."""

import numpy as np
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
