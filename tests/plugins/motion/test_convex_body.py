"""Convex bodies: inside is inside, the surface is covered."""

from itertools import product

import numpy as np
import pytest
from executive_plugins.motion.convex_body import ConvexBody

from executive.errors import ShapeError

CORNERS = np.array(list(product((-0.5, 0.5), (-1.0, 1.0), (-0.25, 0.25))))


def box() -> ConvexBody:
    return ConvexBody("link", CORNERS, "box")


def test_depths_are_distances_to_the_nearest_face_inside() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.0, 0.25], [0.0, 1.5, 0.0]])
    np.testing.assert_allclose(box().depths(points), [0.25, 0.1, 0.0, -0.5], atol=1e-9)


def test_faces_look_outward() -> None:
    a, b, c = (box().corners[box().faces[:, i]] for i in range(3))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a) > 0).all()


def test_samples_lie_on_the_surface_and_leave_no_gap() -> None:
    samples = box().samples
    np.testing.assert_allclose(box().depths(samples), 0.0, atol=1e-9)
    rng = np.random.default_rng(0)
    on_top = np.c_[rng.uniform(-0.5, 0.5, 200), rng.uniform(-1.0, 1.0, 200), np.full(200, 0.25)]
    gaps = np.linalg.norm(on_top[:, None] - samples[None], axis=2).min(axis=1)
    assert gaps.max() < 0.12


def test_its_sphere_holds_all_corners() -> None:
    centre, radius = box().sphere
    assert np.linalg.norm(CORNERS - centre, axis=1).max() <= radius + 1e-12


def test_refuses_points_in_one_plane_and_names_the_body() -> None:
    with pytest.raises(ShapeError, match="flat: 4 points that span no volume"):
        _ = ConvexBody(
            "link", np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]]), "flat"
        ).corners
