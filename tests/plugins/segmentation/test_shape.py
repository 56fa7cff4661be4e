"""Moments, boxes and planes of point sets."""

import numpy as np
from executive_plugins.segmentation.shape import (
    counts_near,
    moments,
    planes_through,
    principal_extents,
)

from executive.geometry.rotation import from_rpy


def test_moments_are_those_of_the_textbook() -> None:
    points = np.random.default_rng(0).normal(size=(500, 3)) * [3, 2, 1] + [10, -4, 2]
    mean, scatter = moments(points)
    np.testing.assert_allclose(mean, points.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(scatter / (len(points) - 1), np.cov(points.T), rtol=1e-12)


def test_extents_do_not_turn_with_the_frame() -> None:
    corners = np.array([[x, y, z] for x in (-1.5, 1.5) for y in (-1, 1) for z in (-0.5, 0.5)])
    turned = corners @ from_rpy(0.3, -0.8, 1.1).T + [5, 6, 7]
    np.testing.assert_allclose(principal_extents(turned), [3, 2, 1], atol=1e-9)


def test_planes_pass_through_their_points_with_the_normal_up() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(size=(50, 3))
    triples = np.array([rng.choice(50, 3, replace=False) for _ in range(20)]).T
    planes = planes_through(points, triples)
    for plane, triple in zip(planes, triples.T, strict=True):
        np.testing.assert_allclose(points[triple] @ plane[:3], plane[3], atol=1e-12)
        assert plane[2] >= 0
    near = np.abs(points @ planes[:, :3].T - planes[:, 3]) < 0.3
    np.testing.assert_array_equal(counts_near(points, planes, 0.3), near.sum(axis=0))


def test_points_on_a_line_make_no_plane() -> None:
    points = np.outer(np.arange(5.0), [1, 2, 3])
    assert len(planes_through(points, np.array([[0], [1], [2]]))) == 0
