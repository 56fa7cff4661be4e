"""Local frames on shapes whose curvature is known."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.frames import (
    downward_frames,
    local_frames,
    turned_frames,
)

from executive.geometry.normals import outward_normals


def cylinder(radius_m: float, length_m: float) -> np.ndarray:
    angle, along = np.meshgrid(
        np.linspace(0, 2 * np.pi, 90, endpoint=False), np.linspace(0, length_m, 60)
    )
    return np.column_stack(
        [along.ravel(), radius_m * np.cos(angle.ravel()), radius_m * np.sin(angle.ravel())]
    )


def sphere(radius_m: float, n: int = 3000) -> np.ndarray:
    i = np.arange(n) + 0.5  # Fibonacci's spiral: even over the sphere
    polar, azimuth = np.arccos(1 - 2 * i / n), np.pi * (1 + 5**0.5) * i
    ring = np.sin(polar)
    return radius_m * np.column_stack(
        [np.cos(azimuth) * ring, np.sin(azimuth) * ring, np.cos(polar)]
    )


def test_normals_of_a_sphere_point_outward() -> None:
    points = sphere(0.5)
    normals = outward_normals(points, np.zeros(3))
    assert (np.einsum("ij,ij->i", normals, points) / 0.5).min() > np.cos(np.radians(3))


def test_on_a_cylinder_x_is_the_normal_and_z_the_axis() -> None:
    points = cylinder(0.4, 2.0)
    at = points[np.abs(points[:, 0] - 1.0) < 0.3][::50]
    normals = outward_normals(points, np.array([1.0, 0.0, 0.0]))
    for frame, p in zip(local_frames(points, normals, at, 0.2), at, strict=True):
        outward = np.array([0.0, p[1], p[2]]) / 0.4
        assert frame[:, 0] @ outward > np.cos(np.radians(3))
        assert abs(frame[0, 2]) > np.cos(np.radians(3))


def test_on_a_plane_x_is_the_normal() -> None:
    x, y = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 40))
    points = np.column_stack([x.ravel(), y.ravel(), 0.3 * x.ravel()])
    normals = outward_normals(points, np.array([0.0, 0.0, -5.0]))
    frame = local_frames(points, normals, np.zeros((1, 3)), 0.4)[0]
    np.testing.assert_allclose(frame[:, 0], np.array([-0.3, 0, 1]) / np.hypot(0.3, 1), atol=1e-6)


def test_frames_are_right_handed_rotations() -> None:
    points = sphere(0.5)
    frames = local_frames(points, outward_normals(points, np.zeros(3)), points[::300], 0.2)
    for R in (
        *frames,
        *turned_frames(frames, np.array([-0.5, 0.0]), np.array([0.3])),
        *downward_frames(np.arange(3.0)),
    ):
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-9)
        assert np.linalg.det(R) == pytest.approx(1.0)


def test_an_unturned_approach_goes_into_the_stone_and_opens_across_the_axis() -> None:
    points = cylinder(0.4, 2.0)
    frame = local_frames(
        points, outward_normals(points, np.array([1.0, 0, 0])), np.array([[1.0, 0.0, 0.4]]), 0.2
    )
    approach = turned_frames(frame, np.zeros(1), np.zeros(1))[0]
    np.testing.assert_allclose(approach[:, 0], [0, 0, -1], atol=0.05)
    assert abs(approach[1, 1]) > 0.99


def test_turns_about_z_tilt_the_approach_by_their_angle() -> None:
    frame = np.eye(3)[None]
    turned = turned_frames(frame, np.zeros(1), np.radians([-40.0, 0.0, 40.0]))
    np.testing.assert_allclose(np.arccos(-turned[:, 0, 0]), np.radians([40, 0, 40]), atol=1e-9)


def test_downward_frames_approach_along_gravity_with_the_opening_at_the_yaw() -> None:
    R = downward_frames(np.array([0.0, 0.7]))
    np.testing.assert_allclose(R[:, :, 0], [[0, 0, -1]] * 2)
    np.testing.assert_allclose(np.arctan2(R[:, 1, 1], R[:, 0, 1]), [0.0, 0.7])
