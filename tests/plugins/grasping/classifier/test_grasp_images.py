"""Grasp images: a known point falls in a known pixel, and mirrored scenes give mirrored images."""

import numpy as np
import pytest
from executive_plugins.grasping.classifier.grasp_images import (
    CHANNELS,
    PER_VIEW,
    PIXELS,
    Images,
    draw_images,
    image_cube,
    mirrored,
)

from executive.arrays import Float
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

CUBE = (np.zeros(3), 3.2)  # a pixel is 0.1 m
HERE = np.array([[0.0, 0.0, 0.0]])
AS_IS = np.eye(3)[None]


def draw(points: Float, targets: int, normals: Float, R: Float = AS_IS, at: Float = HERE) -> Images:
    is_target = np.arange(len(points)) < targets
    return draw_images(points, is_target, normals, R, at, CUBE)


def test_a_known_point_of_the_target_falls_in_known_pixels_with_its_depth_and_normal() -> None:
    point, normal = np.array([[0.25, 1.05, 2.45]]), np.array([[0.0, -0.6, 0.8]])
    image = draw(point, 1, normal)[0]
    views = {0: (10, 24), 1: (2, 24), 2: (2, 10)}  # a, b, c in pixels: 2, 10, 24
    expected = np.zeros((CHANNELS, PIXELS, PIXELS))
    for view, (row, column) in views.items():
        depth = point[0, view] / 3.2
        channels = slice(view * PER_VIEW, (view + 1) * PER_VIEW)
        expected[channels, row, column] = (1 - depth, depth, 0, 0, abs(normal[0, view]))
    np.testing.assert_allclose(image, expected, atol=1e-6)


def test_what_is_not_the_target_has_channels_of_its_own_and_no_normals() -> None:
    image = draw(np.array([[0.25, 1.05, 2.45]]), 0, np.empty((0, 3)))[0]
    assert set(np.flatnonzero(image.any(axis=(1, 2)))) == {2, 3, 7, 8, 12, 13}


def test_of_two_points_in_a_pixel_the_nearest_to_each_end_counts_and_normals_are_averaged() -> None:
    points, normals = (
        np.array([[0.8, 1.05, 1.05], [2.4, 1.05, 1.05]]),
        np.array([[1.0, 0, 0], [0.5, 0.5, 0.7]]),
    )
    np.testing.assert_allclose(
        draw(points, 2, normals)[0, :PER_VIEW, 10, 10], (0.75, 0.75, 0, 0, 0.75), atol=1e-6
    )


def test_points_outside_the_cube_are_not_drawn() -> None:
    outside = np.array([[-0.01, 1.0, 1.0], [1.0, 3.21, 1.0], [1.0, 1.0, 3.2]])
    assert not draw(outside, 3, np.tile([1.0, 0, 0], (3, 1))).any()


def test_a_scene_moved_with_the_gripper_gives_the_same_images(gripper: Gripper) -> None:
    rng = np.random.default_rng(0)
    points, normals = rng.uniform(0.2, 3.0, (200, 3)), np.tile([0.0, 0.0, 1.0], (200, 1))
    R, t = exp_so3(np.array([0.3, -0.8, 0.5])), np.array([4.0, -2.0, 1.0])
    here = draw(points, 200, normals)
    moved = draw(points @ R.T + t, 200, normals @ R.T, R[None], t[None])
    assert (
        np.abs(here - moved) > 1e-3
    ).mean() < 1e-4  # a point on an edge of pixels may fall on its other side


def test_a_gripper_of_another_scale_draws_the_same(gripper: Gripper) -> None:
    corner, edge = image_cube(gripper)
    points = corner + np.random.default_rng(0).uniform(0.05, 0.95, (50, 3)) * edge
    normals = np.tile([0.0, 0.0, 1.0], (50, 1))
    images = [
        draw_images(points * s, np.ones(50, bool), normals, AS_IS, HERE, (corner * s, edge * s))
        for s in (1, 0.05)
    ]
    np.testing.assert_allclose(*images, atol=1e-5)


@pytest.mark.parametrize("axis", [1, 2])
def test_images_of_a_mirrored_scene_are_mirrored_images(axis: int) -> None:
    rng = np.random.default_rng(1)
    points, normals = rng.uniform(0.05, 3.15, (100, 3)), rng.normal(size=(100, 3))
    turned = points.copy()
    turned[:, axis] = 3.2 - turned[:, axis]
    np.testing.assert_allclose(
        draw(turned, 60, normals[:60]), mirrored(draw(points, 60, normals[:60]), axis), atol=1e-5
    )
