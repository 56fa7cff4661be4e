"""The pose in the jaws: a look is weighed against the expectation."""

import numpy as np
import pytest

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.leaf.held_pose import held_pose
from executive.messages.alignment import Uncertainty

CENTRE = np.array([0.1, -0.2, 0.9])
SHARP = Uncertainty(np.diag([1e-8] * 3 + [1e-8] * 3), np.zeros(3))


def test_a_sharp_look_is_believed():
    T = pose(exp_so3(np.array([0.1, -0.2, 0.05])), np.array([0.04, 0.02, -0.03]))
    found = held_pose(T, SHARP, CENTRE, 0.03, 0.05)
    np.testing.assert_allclose(found.T_gripper_gripper, T, atol=1e-3)
    shift = transform(T, CENTRE[None])[0] - CENTRE
    assert found.shift_m == pytest.approx(np.linalg.norm(shift), abs=1e-3)
    assert found.turn_rad == pytest.approx(np.linalg.norm([0.1, -0.2, 0.05]), abs=1e-3)
    assert found.position_std_m < 1e-3


def test_what_the_view_does_not_determine_stays_as_expected():
    look = Uncertainty(np.diag([1e-6] * 5 + [4.0]), CENTRE)
    found = held_pose(pose(t=np.array([0.02, 0.0, 0.03])), look, CENTRE, 0.03, 0.05)
    assert found.T_gripper_gripper[0, 3] == pytest.approx(0.02, abs=1e-3)
    assert abs(found.T_gripper_gripper[2, 3]) < 1e-3
    assert found.position_std_m == pytest.approx(0.03, rel=0.01)


def test_a_motion_beyond_the_expectation_widens_it():
    look = Uncertainty(np.diag([0.03**2] * 6), CENTRE)
    far = held_pose(pose(t=np.array([0.35, 0.0, 0.0])), look, CENTRE, 0.03, 0.05)
    near = held_pose(pose(t=np.array([0.03, 0.0, 0.0])), look, CENTRE, 0.03, 0.05)
    assert near.shift_m == pytest.approx(0.015, abs=1e-3)  # both are worth the same
    assert far.shift_m > 0.3


def test_the_error_of_a_rotation_about_a_far_point_is_one_of_the_position():
    turning = Uncertainty(np.diag([0.05**2] * 3 + [1e-8] * 3), CENTRE + [1.0, 0.0, 0.0])
    found = held_pose(np.eye(4), turning, CENTRE, 10.0, 10.0)
    assert found.position_std_m == pytest.approx(0.05, rel=0.05)
