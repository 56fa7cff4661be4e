"""What every grasp planner must do, whatever its method."""

import numpy as np
import pytest

from executive import registry
from executive.arrays import Float
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import Stone, StoneState


class FreeMotion(MotionPlanner):
    """Reaches everything."""

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


@pytest.fixture(scope="module", params=[plugin.name for plugin in registry.installed("grasping")])
def planner(request: pytest.FixtureRequest) -> GraspPlanner:
    plugin = registry.load("grasping", request.param)
    services = {"machine": load_machine("m545"), "motion": FreeMotion()}
    return plugin(plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin)))


@pytest.fixture(scope="module")
def scene() -> tuple[Stone, Cloud]:
    """An egg of a stone on level ground."""
    i = np.arange(4000) + 0.5
    polar, azimuth = np.arccos(1 - 2 * i / 4000), np.pi * (1 + 5**0.5) * i
    unit = np.column_stack(
        [np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)]
    )
    stone = unit[unit[:, 2] > -0.7] * (0.62, 0.45, 0.4) + (5.0, 1.0, 0.4)
    xy = np.random.default_rng(0).uniform((1, -3), (9, 5), (15000, 2))
    ground = np.column_stack([xy, np.zeros(len(xy))])
    points = np.concatenate([stone, ground])
    return Stone(1, StoneState.ON_GROUND, stone, stone.mean(axis=0), np.eye(4), True), Cloud(
        "map", points
    )


def test_it_is_a_grasp_planner(planner: GraspPlanner) -> None:
    assert isinstance(planner, GraspPlanner)


def test_an_egg_is_grasped_with_its_centre_between_the_jaws(
    planner: GraspPlanner, scene: tuple[Stone, Cloud]
) -> None:
    plan = planner.plan(*scene, np.eye(4), np.random.default_rng(0))
    assert plan.grasps
    best = plan.grasps[0]
    ahead, across, along = best.T_map_gripper[:3, :3].T @ (
        np.array([5.0, 1.0, 0.4]) - best.T_map_gripper[:3, 3]
    )
    assert 0.3 < ahead < 1.3
    assert abs(across) < 0.3
    assert abs(along) < 0.3
    assert {"align_rad", "enclose_m", "distance_m"} <= set(best.costs)


def test_grasps_are_rigid_poses_in_order_of_their_score(
    planner: GraspPlanner, scene: tuple[Stone, Cloud]
) -> None:
    plan = planner.plan(*scene, np.eye(4), np.random.default_rng(0))
    for grasp in plan.grasps:
        R = grasp.T_map_gripper[:3, :3]
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-9)
        assert np.linalg.det(R) > 0
        assert grasp.opening_m > 0
    assert [g.score for g in plan.grasps] == sorted((g.score for g in plan.grasps), reverse=True)


def test_one_seed_gives_one_plan(planner: GraspPlanner, scene: tuple[Stone, Cloud]) -> None:
    a, b = (planner.plan(*scene, np.eye(4), np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(
        [g.T_map_gripper for g in a.grasps], [g.T_map_gripper for g in b.grasps]
    )
    assert dict(a.refused) == dict(b.refused)


def test_a_stone_that_is_too_large_gives_reasons_and_no_grasp(
    planner: GraspPlanner, scene: tuple[Stone, Cloud]
) -> None:
    stone, cloud = scene
    large = (stone.points_map - (5.0, 1.0, 0.0)) * 3.0 + (5.0, 1.0, 0.0)
    hill = Stone(1, StoneState.ON_GROUND, large, large.mean(axis=0), np.eye(4), True)
    plan = planner.plan(
        hill,
        Cloud("map", np.concatenate([cloud.points, large])),
        np.eye(4),
        np.random.default_rng(0),
    )
    assert plan.grasps == ()
    assert sum(plan.refused.values()) > 0
