"""The turn between cabin and chassis, of a machine that turns and of a rig that is one body."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import about_axis
from executive.machine.machine import load_machine
from executive.messages.joints import JointSample

M545 = load_machine("m545")
TURN = M545.joint_names.index(M545.turn_joint)
AXIS = np.array([0.0, 0.0, 1.0])


def sample(stamp_s: float, angle_rad: float, rate_rad_s: float) -> JointSample:
    position, velocity = np.full((2, len(M545.joint_names)), 7.0)
    position[TURN], velocity[TURN] = angle_rad, rate_rad_s
    return JointSample(stamp_s, M545.joint_names, position, velocity, np.zeros(len(position)))


def test_a_rig_without_a_turn_joint_is_one_body_whose_frames_agree() -> None:
    turn = TurnJoint(SimpleNamespace(turn_joint=None))
    assert turn.is_known
    turn.update(sample(1.0, 0.5, 0.2))
    np.testing.assert_array_equal(turn.T_cabin_base(1.0), np.eye(4))
    np.testing.assert_array_equal(turn.rate_cabin, np.zeros(3))
    np.testing.assert_array_equal(turn.axis, AXIS)
    assert turn.stamp_s == -np.inf


@pytest.mark.parametrize(
    ("ahead_s", "counted_s"), [(0.0, 0.0), (0.05, 0.05), (0.1, 0.1), (0.5, 0.1), (-0.5, -0.1)]
)
def test_the_turn_is_extrapolated_by_a_tenth_of_a_second_at_most(
    ahead_s: float, counted_s: float
) -> None:
    turn = TurnJoint(M545)
    assert not turn.is_known
    turn.update(sample(2.0, 0.5, 0.2))
    assert turn.is_known
    np.testing.assert_allclose(turn.rate_cabin, 0.2 * AXIS)
    joint = M545.joints[M545.arm_names.index(M545.turn_joint)]
    angle_rad = 0.5 + 0.2 * counted_s
    T_base_cabin = joint.T_parent_joint @ pose(about_axis(AXIS, angle_rad))
    np.testing.assert_allclose(turn.T_cabin_base(2.0 + ahead_s), inverse(T_base_cabin), atol=1e-12)
