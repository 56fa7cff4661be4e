"""What every grasp planner must do, whatever its method."""

import numpy as np

from executive.interfaces.grasping import GraspPlanner
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from executive.testing.exercises.grasping import egg
from executive.testing.pytest_plugin import Insist

CAPABILITY = "grasping"


def test_an_egg_is_grasped_with_its_centre_between_the_jaws(
    plugin: GraspPlanner, insist: Insist
) -> None:
    plan = plugin.plan(*egg(), np.eye(4), np.random.default_rng(0))
    insist(plan.grasps, f"it finds no grasp of an egg of 1.2 m: {dict(plan.refused)}")
    best = plan.grasps[0]
    ahead, across, along = best.T_map_gripper[:3, :3].T @ (
        np.array([5.0, 1.0, 0.4]) - best.T_map_gripper[:3, 3]
    )
    assert 0.3 < ahead < 1.3
    assert abs(across) < 0.3
    assert abs(along) < 0.3
    assert {"align_rad", "enclose_m", "distance_m"} <= set(best.costs)


def test_grasps_are_rigid_poses_in_order_of_their_score(plugin: GraspPlanner) -> None:
    plan = plugin.plan(*egg(), np.eye(4), np.random.default_rng(0))
    for grasp in plan.grasps:
        R = grasp.T_map_gripper[:3, :3]
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-9)
        assert np.linalg.det(R) > 0
        assert grasp.opening_m > 0
    assert [g.score for g in plan.grasps] == sorted((g.score for g in plan.grasps), reverse=True)


def test_a_stone_that_is_too_large_gives_reasons_and_no_grasp(plugin: GraspPlanner) -> None:
    stone, cloud = egg()
    large = (stone.points_map - (5.0, 1.0, 0.0)) * 3.0 + (5.0, 1.0, 0.0)
    hill = Stone(1, StoneState.ON_GROUND, large, large.mean(axis=0), np.eye(4), True)
    plan = plugin.plan(
        hill,
        Cloud("map", np.concatenate([cloud.points, large])),
        np.eye(4),
        np.random.default_rng(0),
    )
    assert plan.grasps == ()
    assert sum(plan.refused.values()) > 0
