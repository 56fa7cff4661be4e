"""Parts of a cloud."""

import numpy as np

from executive.messages.cloud import Cloud

RNG = np.random.default_rng(0)

CLOUD = Cloud("map", RNG.uniform(-2, 2, (500, 3)))


def test_near_is_measured_horizontally() -> None:
    cloud = Cloud("map", np.array([[0.9, 0, 50.0], [0.0, 1.1, 0.0]]))
    np.testing.assert_array_equal(cloud.near(np.zeros(3), 1.0).points, [[0.9, 0, 50.0]])
    np.testing.assert_array_equal(cloud.near(np.array([0.0, 1.0]), 1.0).points, [[0.0, 1.1, 0.0]])


def test_a_box_includes_its_limits() -> None:
    cloud = Cloud("map", np.array([[1.0, 1, 1], [1.0, 1, 1.1], [0.0, 0, 0]]))
    inside = cloud.in_box(np.zeros(3), np.ones(3))
    np.testing.assert_array_equal(inside.points, [[1.0, 1, 1], [0.0, 0, 0]])


def test_a_part_keeps_its_frame_and_its_own_normals() -> None:
    normals = RNG.normal(size=(500, 3))
    cloud = Cloud("drone", CLOUD.points, normals)
    for part in (cloud.near(np.zeros(2), 1.0), cloud.in_box(-np.ones(3), np.ones(3))):
        assert part.frame == "drone"
        assert 0 < len(part) < len(cloud)
        assert part.normals is not None
        for point, normal in zip(part.points, part.normals, strict=True):
            row = np.flatnonzero((cloud.points == point).all(axis=1))
            np.testing.assert_array_equal(normals[row[0]], normal)
    assert Cloud("map", CLOUD.points).near(np.zeros(2), 1.0).normals is None
