"""The cabin's motion between its samples."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.motion import Motion


def turning(stamps_s: list[float], rate_rad_s: float = 0.5) -> Motion:
    """A cabin that turns evenly while it creeps along x."""
    poses = np.stack(
        [pose(from_rpy(0, 0, rate_rad_s * t), np.array([0.1 * t, 0, 2.0])) for t in stamps_s]
    )
    return Motion(
        stamps_s, poses, ("turn", "boom"), np.array([[rate_rad_s * t, 1.0] for t in stamps_s])
    )


def test_an_even_motion_is_interpolated_exactly() -> None:
    motion = turning([0.0, 0.1, 0.25, 0.4])
    for t in (0.0, 0.03, 0.1, 0.17, 0.25, 0.39, 0.4):
        expected = pose(from_rpy(0, 0, 0.5 * t), np.array([0.1 * t, 0, 2.0]))
        np.testing.assert_allclose(motion.T_map_cabin_at(t), expected, atol=1e-12)
        np.testing.assert_allclose(motion.joints_at(t), [0.5 * t, 1.0], atol=1e-12)


@pytest.mark.parametrize(("t", "held"), [(-1.0, 0), (9.0, -1)])
def test_the_ends_hold_beyond_the_window(t: float, held: int) -> None:
    motion = turning([0.0, 0.1, 0.2])
    np.testing.assert_allclose(motion.T_map_cabin_at(t), motion.T_map_cabin[held], atol=1e-12)
    np.testing.assert_allclose(motion.joints_at(t), motion.joint_position[held])


def test_one_sample_holds_for_ever() -> None:
    motion = turning([3.0])
    for t in (0.0, 3.0, 10.0):
        np.testing.assert_array_equal(motion.T_map_cabin_at(t), motion.T_map_cabin[0])
        np.testing.assert_array_equal(motion.joints_at(t), motion.joint_position[0])
