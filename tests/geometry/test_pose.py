"""Poses: group axioms and the way they act on points."""

import numpy as np
import pytest

from executive.geometry.pose import adjoint, interpolate, inverse, pose, pose_xyz_rpy, transform
from executive.geometry.rotation import angle_between, exp_so3, from_rpy, log_so3


def some_poses(n: int) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    return [pose(exp_so3(rng.uniform(-1.5, 1.5, 3)), rng.uniform(-20, 20, 3)) for _ in range(n)]


def test_the_inverse_undoes_a_pose_from_both_sides() -> None:
    for T in some_poses(10):
        np.testing.assert_allclose(T @ inverse(T), np.eye(4), atol=1e-12)
        np.testing.assert_allclose(inverse(T) @ T, np.eye(4), atol=1e-12)


def test_transforming_by_a_product_is_transforming_twice() -> None:
    T_a_b, T_b_c = some_poses(2)
    points_c = np.random.default_rng(2).normal(0, 5, (30, 3))
    np.testing.assert_allclose(
        transform(T_a_b @ T_b_c, points_c), transform(T_a_b, transform(T_b_c, points_c))
    )


def test_one_point_is_transformed_like_many() -> None:
    T = some_poses(1)[0]
    points = np.random.default_rng(3).normal(0, 5, (4, 3))
    np.testing.assert_allclose([transform(T, p) for p in points], transform(T, points))


def test_transforming_keeps_distances() -> None:
    T = some_poses(1)[0]
    a, b = np.random.default_rng(4).normal(0, 5, (2, 3))
    assert np.linalg.norm(transform(T, a) - transform(T, b)) == pytest.approx(np.linalg.norm(a - b))


def test_parts_that_are_left_out_are_none() -> None:
    np.testing.assert_array_equal(pose(), np.eye(4))
    np.testing.assert_array_equal(pose(t=np.array([1.0, 2, 3]))[:3, :3], np.eye(3))
    np.testing.assert_array_equal(pose(R=from_rpy(0, 0, 1))[:3, 3], np.zeros(3))


def test_an_urdf_origin_is_a_translation_and_fixed_axis_angles() -> None:
    T = pose_xyz_rpy([1, 2, 3], [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(T[:3, 3], [1, 2, 3])
    np.testing.assert_allclose(T[:3, :3], from_rpy(0.1, 0.2, 0.3))


def test_interpolation_begins_ends_and_moves_evenly() -> None:
    T_a, T_b = some_poses(2)
    np.testing.assert_allclose(interpolate(T_a, T_b, 0.0), T_a, atol=1e-12)
    np.testing.assert_allclose(interpolate(T_a, T_b, 1.0), T_b, atol=1e-12)
    whole = angle_between(T_a[:3, :3], T_b[:3, :3])
    for fraction in (0.25, 0.5, 0.9):
        T = interpolate(T_a, T_b, fraction)
        assert angle_between(T_a[:3, :3], T[:3, :3]) == pytest.approx(fraction * whole)
        np.testing.assert_allclose(T[:3, 3], (1 - fraction) * T_a[:3, 3] + fraction * T_b[:3, 3])


def test_the_adjoint_carries_a_small_motion_to_the_other_frame() -> None:
    for T in some_poses(5):
        twist = np.random.default_rng(5).normal(0, 1e-7, 6)
        small = pose(exp_so3(twist[:3]), twist[3:])
        moved = T @ small @ inverse(T)
        expected = adjoint(T) @ twist
        np.testing.assert_allclose(log_so3(moved[:3, :3]), expected[:3], atol=1e-12)
        np.testing.assert_allclose(moved[:3, 3], expected[3:], atol=1e-11)


def test_the_adjoint_of_a_product_is_the_product_of_the_adjoints() -> None:
    T_a_b, T_b_c = some_poses(2)
    np.testing.assert_allclose(adjoint(T_a_b @ T_b_c), adjoint(T_a_b) @ adjoint(T_b_c), atol=1e-12)
