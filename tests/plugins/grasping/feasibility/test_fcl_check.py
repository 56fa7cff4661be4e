"""FCL's word on the gripper in a cloud, against half-spaces."""

import numpy as np
from executive_plugins.grasping.feasibility.fcl_check import FclCheck

from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

ALLOWED_M, MARGIN_M = 0.01, 1e-4  # nearer to the limit than this, the two may differ
T = pose(exp_so3(np.array([0.4, -1.1, 0.3])), np.array([5.0, -2.0, 1.0]))


def test_what_is_deeper_than_allowed_is_what_half_spaces_say(gripper: Gripper) -> None:
    hulls = [hull for parts in gripper.hulls(gripper.open_rad).values() for hull in parts]
    faces = [half_spaces(hull) for hull in hulls]
    rng, recheck = np.random.default_rng(0), FclCheck(gripper, ALLOWED_M)
    # About corners of the parts, where depths are small.
    at = np.concatenate(hulls)[rng.integers(0, sum(map(len, hulls)), 600)] + rng.normal(
        0, 0.03, (600, 3)
    )
    depth_m = np.max([depth_inside(part, at) for part in faces], axis=0)
    is_free = np.array([recheck.is_free(transform(T, point[None]), T) for point in at])
    clear = np.abs(depth_m - ALLOWED_M) > MARGIN_M
    np.testing.assert_array_equal(is_free[clear], depth_m[clear] < ALLOWED_M)
    assert 30 < (~is_free).sum() < 570


def test_one_deep_point_among_many_is_found(gripper: Gripper) -> None:
    recheck = FclCheck(gripper, ALLOWED_M)
    between_the_jaws = np.tile(gripper.grasp_centre, (50, 1))
    in_the_palm = np.array([[-0.2, 0.0, 0.0]])
    assert recheck.is_free(transform(T, between_the_jaws), T)
    assert not recheck.is_free(transform(T, np.concatenate([between_the_jaws, in_the_palm])), T)
    assert recheck.is_free(np.empty((0, 3)), T)


def test_parts_thinner_than_what_is_allowed_hit_nothing(gripper: Gripper) -> None:
    assert FclCheck(gripper, 5.0).is_free(np.array([[-0.2, 0.0, 0.0]]), np.eye(4))
