"""Returns from the machine's own arm are found, and those of the ground are kept."""

import numpy as np
from executive_plugins.odometry.own_returns import OwnReturns

from executive.geometry.pose import inverse, transform
from executive.machine.kinematics import Kinematics
from executive.messages.lidar import LidarScan


def scan_of(points_base: np.ndarray, frames) -> LidarScan:
    points = transform(inverse(frames["lidar_horizontal"]), points_base)
    return LidarScan(1.0, "lidar_horizontal", points, np.full(len(points), 1.0))


def test_a_point_in_the_arm_is_the_machines_and_one_beside_it_is_not(yard) -> None:
    standing = yard()
    own = OwnReturns(standing.machine)
    joints = standing.joints(1.0)
    frames = Kinematics(standing.machine).frames(joints.position[:-1], 0.0)
    boom = standing.machine.links["boom"].shapes[0].vertices.mean(axis=0)
    points = np.array([transform(frames["boom"], boom), [0.0, 8.0, -0.9], frames["gripper"][:3, 3]])
    assert not own.among(
        scan_of(points, frames)
    ).any()  # it cannot know before the first joint sample
    own.add_joints(joints)
    np.testing.assert_array_equal(own.among(scan_of(points, frames)), [True, False, True])
