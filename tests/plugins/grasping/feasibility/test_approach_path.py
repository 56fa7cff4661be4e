"""The open gripper on its way down."""

import numpy as np
from executive_plugins.grasping.feasibility.approach_path import ApproachPath
from executive_plugins.grasping.sampling.frames import downward_frames

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

UP = np.array([0.0, 0.0, 1.0])
DOWN = downward_frames(np.zeros(1))[0]


def test_a_point_in_the_palm_is_as_deep_as_its_distance_to_the_face(gripper: Gripper) -> None:
    approach = ApproachPath(gripper)
    T = pose(DOWN, np.array([5.0, 0.0, 1.0]))
    assert abs(approach.depth_m(np.array([[5.0, 0.0, 1.05]]), T) - 0.05) < 1e-9
    assert approach.depth_m(np.array([[5.0, 0.0, 0.8]]), T) < 0
    assert approach.depth_m(np.array([[50.0, 0.0, 0.8]]), T) == -np.inf


def test_a_tilted_gripper_meets_on_its_way_what_it_does_not_meet_at_its_end(
    gripper: Gripper,
) -> None:
    R = exp_so3(np.array([0.0, 0.5, 0.0])) @ DOWN
    T = pose(R, np.array([0.0, 0.0, 1.0]))
    palm = gripper.hulls(gripper.open_rad)["palm"][0].mean(axis=0)
    obstacle = transform(T, palm) + np.array([[0.0, 0.0, 0.7]])
    approach = ApproachPath(gripper)
    assert approach.is_free(obstacle, T, UP, 0.0, 0.01)
    assert not approach.is_free(obstacle, T, UP, 1.0, 0.01)


def test_an_empty_cloud_is_free(gripper: Gripper) -> None:
    assert ApproachPath(gripper).is_free(np.empty((0, 3)), np.eye(4), UP, 1.0, 0.01)
