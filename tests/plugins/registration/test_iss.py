"""Normals and keypoints on shapes whose normals and corners are known."""

import numpy as np
from executive_plugins.registration.iss import salient_points, surface_shapes
from executive_plugins.registration.neighbours import neighbours_within

from executive.geometry.rotation import from_rpy


def box() -> np.ndarray:
    """Points 4 cm apart on the six faces of a box of 1.2 × 0.9 × 0.6 m about the origin."""
    sides = np.array([1.2, 0.9, 0.6])
    axes = [np.arange(-side / 2, side / 2 + 0.001, 0.0375) for side in sides]
    grid = np.array(np.meshgrid(*axes, indexing="ij")).reshape(3, -1).T
    return grid[(np.abs(np.abs(grid) - sides / 2) < 1e-9).any(axis=1)]


def test_normals_of_a_sphere_point_outward() -> None:
    d = np.random.default_rng(0).normal(size=(4000, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    normals, _ = surface_shapes(0.6 * d + 3.0, *neighbours_within(0.6 * d, 0.6 * d, 0.12))
    angles = np.arccos(np.clip(np.einsum("ij,ij->i", normals, d), -1, 1))
    assert np.degrees(angles).max() < 6.0  # sampling leaves neighbours uneven


def test_a_plane_has_no_keypoint() -> None:
    axis = np.arange(0, 1, 0.04)
    plane = np.array(np.meshgrid(axis, axis, [0.0])).reshape(3, -1).T
    normals, saliencies = surface_shapes(plane, *neighbours_within(plane, plane, 0.12))
    np.testing.assert_allclose(np.abs(normals[:, 2]), 1.0)
    assert saliencies.max() < 1e-12


def test_the_corners_of_a_box_stand_out_wherever_it_stands() -> None:
    corners = np.array(np.meshgrid([-0.6, 0.6], [-0.45, 0.45], [-0.3, 0.3])).reshape(3, -1).T
    for R in (np.eye(3), from_rpy(0.4, -0.7, 2.0)):
        points = box() @ R.T + 5.0
        neighbours = neighbours_within(points, points, 0.12)
        saliencies = surface_shapes(points, *neighbours)[1]
        chosen = points[salient_points(saliencies, *neighbours)]
        to_corner = np.linalg.norm(chosen[:, None] - (corners @ R.T + 5.0), axis=2)
        assert to_corner.min(axis=0).max() < 0.08


def test_too_few_neighbours_shape_no_normal() -> None:
    points = np.eye(3)
    normals, saliencies = surface_shapes(points, *neighbours_within(points, points, 0.1))
    assert not normals.any()
    assert not saliencies.any()
    assert len(salient_points(saliencies, *neighbours_within(points, points, 0.1))) == 0


def saliency_of_an_apex(half_axes_m: tuple[float, float], depth_m: float) -> float:
    """Return the saliency of a point above the middle of an elliptic ring of twelve points."""
    angle = np.arange(12) * 2 * np.pi / 12
    ring = np.column_stack([*(np.array(half_axes_m)[:, None] * [np.cos(angle), np.sin(angle)]),
                            np.full(12, -depth_m)])  # fmt: skip
    points = np.vstack([np.zeros(3), ring])
    return float(surface_shapes(points, *neighbours_within(points, points, 0.3))[1][0])


def test_a_point_stands_out_only_if_all_three_axes_are_told_apart() -> None:
    """Zhong 2009, Eq. (4): with two equal eigenvalues, two axes can be turned at will.

    The ring's scatter about the apex is a²/2, b²/2 and h².
    """
    assert saliency_of_an_apex((0.10, 0.07), 0.03) > 0
    assert saliency_of_an_apex((0.10, 0.10), 0.03) == 0  # the two largest are equal
    assert saliency_of_an_apex((0.10, 0.07), 0.07 / np.sqrt(2)) == 0  # the two smallest are equal
