"""Convex polyhedra by their known volumes and depths."""

from itertools import product

import numpy as np
import pytest

from executive.errors import DataError
from executive.geometry.convex import convex_corners, depth_inside, half_spaces, volume_and_centroid
from executive.geometry.rotation import exp_so3

BOX = np.array(list(product((0.0, 2.0), (0.0, 3.0), (0.0, 1.0))))


def test_a_box_has_six_faces_with_outward_unit_normals() -> None:
    faces = half_spaces(BOX)
    assert faces.shape == (6, 4)
    np.testing.assert_allclose(np.linalg.norm(faces[:, :3], axis=1), 1.0)
    np.testing.assert_allclose(depth_inside(faces, BOX), 0.0, atol=1e-9)


def test_depth_is_the_distance_to_the_nearest_face_and_negative_outside() -> None:
    depths = depth_inside(
        half_spaces(BOX), np.array([[1.0, 1.5, 0.5], [1.0, 1.5, 0.9], [1.0, 1.5, 1.4]])
    )
    np.testing.assert_allclose(depths, [0.5, 0.1, -0.4], atol=1e-9)


def test_volume_and_centroid_move_with_the_body() -> None:
    R, t = exp_so3(np.array([0.3, -0.5, 0.8])), np.array([5.0, -6.0, 7.0])
    volume, centroid = volume_and_centroid(BOX @ R.T + t)
    assert volume == pytest.approx(6.0)
    np.testing.assert_allclose(centroid, R @ [1.0, 1.5, 0.5] + t)


def test_points_inside_are_no_corners() -> None:
    cloud = np.vstack([np.random.default_rng(0).uniform(0.1, 0.9, (50, 3)), BOX])
    corners = convex_corners(cloud)
    assert sorted(map(tuple, corners)) == sorted(map(tuple, BOX))


def test_flat_points_are_refused() -> None:
    with pytest.raises(DataError, match="4 points span no volume"):
        half_spaces(BOX[:4])
