"""Rotations: group axioms, inverse functions, conventions that are written down."""

import numpy as np
import pytest

from executive.geometry.rotation import (
    about_axis,
    angle_between,
    angle_of_jaws,
    exp_so3,
    from_quaternion,
    from_rpy,
    log_so3,
    quaternion_wxyz,
    skew,
    wrap_angle,
    yaw_of,
)

VECTORS = list(np.random.default_rng(0).uniform(-1.7, 1.7, (20, 3)))  # all shorter than π
EPS = 1e-12


@pytest.mark.parametrize("v", VECTORS)
def test_exponential_gives_a_rotation_and_logarithm_takes_it_back(v: np.ndarray) -> None:
    R = exp_so3(v)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=EPS)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(log_so3(R), v, atol=1e-11)


@pytest.mark.parametrize(
    "angle", [0.0, 1e-13, 1e-9, 1e-8, 1.001e-8, 1e-5, 1.0, 3.0, np.pi - 1e-7, np.pi]
)
def test_logarithm_is_exact_from_zero_to_a_half_turn(angle: float) -> None:
    axis = np.array([0.36, -0.48, 0.8])
    v = log_so3(exp_so3(angle * axis))
    np.testing.assert_allclose(
        v if v @ axis >= 0 else -v, angle * axis, atol=1e-9
    )  # at π both signs are right


def test_inverse_product_and_identity_are_those_of_the_group() -> None:
    a, b, c = (exp_so3(v) for v in VECTORS[:3])
    np.testing.assert_allclose((a @ b) @ c, a @ (b @ c), atol=EPS)
    np.testing.assert_allclose(exp_so3(-VECTORS[0]), a.T, atol=EPS)
    np.testing.assert_array_equal(exp_so3(np.zeros(3)), np.eye(3))


def test_exponential_of_parallel_vectors_adds_angles() -> None:
    v = VECTORS[4]
    np.testing.assert_allclose(exp_so3(0.3 * v) @ exp_so3(0.5 * v), exp_so3(0.8 * v), atol=EPS)


def test_derivative_of_the_exponential_is_the_skew_matrix() -> None:
    v, h = VECTORS[5], 1e-6
    derivative = (exp_so3(h * v) - exp_so3(-h * v)) / (2 * h)
    np.testing.assert_allclose(derivative, skew(v), atol=1e-9)


def test_skew_is_the_cross_product() -> None:
    np.testing.assert_allclose(
        skew(VECTORS[0]) @ VECTORS[1], np.cross(VECTORS[0], VECTORS[1]), atol=EPS
    )


@pytest.mark.parametrize(
    "v", [*VECTORS, *(np.pi * np.eye(3)), np.array([3.1, 0, 0]), np.array([0, -3.1, 0.1])]
)
def test_quaternions_and_matrices_say_the_same(v: np.ndarray) -> None:
    R = exp_so3(v)
    q = quaternion_wxyz(R)
    assert q[0] >= 0
    assert np.linalg.norm(q) == pytest.approx(1.0)
    np.testing.assert_allclose(from_quaternion(q), R, atol=1e-12)
    np.testing.assert_allclose(from_quaternion(-3.0 * q), R, atol=1e-12)  # either sign, any length


def test_quaternion_order_is_w_x_y_z() -> None:
    half = np.sqrt(0.5)
    np.testing.assert_allclose(
        quaternion_wxyz(from_rpy(0, 0, np.pi / 2)), [half, 0, 0, half], atol=EPS
    )


def test_roll_pitch_yaw_turn_about_fixed_axes_in_that_order() -> None:
    expected = about_axis([0, 0, 1], 0.3) @ about_axis([0, 1, 0], -0.2) @ about_axis([1, 0, 0], 0.1)
    np.testing.assert_allclose(from_rpy(0.1, -0.2, 0.3), expected, atol=EPS)


def test_heading_counts_from_east_counter_clockwise() -> None:
    assert yaw_of(np.eye(3)) == 0.0
    assert yaw_of(from_rpy(0.1, 0.2, np.pi / 2)) == pytest.approx(np.pi / 2)
    for yaw in (-3.0, -0.5, 2.0):
        assert yaw_of(from_rpy(0.3, -0.4, yaw)) == pytest.approx(yaw)


def test_angle_between_is_a_metric_and_does_not_depend_on_the_frame() -> None:
    a, b, c, frame = (exp_so3(v) for v in VECTORS[6:10])
    assert angle_between(a, a) == pytest.approx(0.0, abs=1e-7)
    assert angle_between(a, b) == pytest.approx(angle_between(b, a))
    assert angle_between(a, c) <= angle_between(a, b) + angle_between(b, c) + 1e-12
    assert angle_between(frame @ a, frame @ b) == pytest.approx(angle_between(a, b))


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0, 0), (np.pi, np.pi), (-np.pi, np.pi), (3.5, 3.5 - 2 * np.pi), (-20.0, -20 + 6 * np.pi)],
)
def test_wrapped_angles_lie_above_minus_pi_up_to_pi(angle: float, wrapped: float) -> None:
    assert wrap_angle(angle) == pytest.approx(wrapped)


def test_exchanged_jaws_are_no_turn_and_any_other_turn_is_its_angle() -> None:
    R = from_rpy(0.3, -0.8, 2.0)
    x, y = np.eye(3)[0], np.eye(3)[1]
    assert angle_of_jaws(R, R @ about_axis(x, np.pi)) == pytest.approx(0.0, abs=1e-7)
    assert angle_of_jaws(R, R @ about_axis(x, np.pi - 0.2)) == pytest.approx(0.2)
    assert angle_of_jaws(R, R @ about_axis(x, 0.4)) == pytest.approx(0.4)
    assert angle_of_jaws(R, R @ about_axis(y, 0.4)) == pytest.approx(0.4)
