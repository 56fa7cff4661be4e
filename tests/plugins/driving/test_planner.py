"""Paths of the chassis to the first goal with a free way, and why there is none."""

import numpy as np
import pytest
from executive_plugins.driving.footprint import footprint
from executive_plugins.driving.planner import Dubins
from executive_plugins.driving.settings import DubinsSettings

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.drive import DrivePlan, DriveRequest, DriveTrouble

M545 = load_machine("m545")
FIXED = M545.model_copy(update={"driving": None})
X = np.arange(-15.0, 15.0, 0.2)
LEVEL = np.append(np.stack(np.meshgrid(X, X), axis=-1).reshape(-1, 2), np.zeros((22500, 1)), axis=1)
AHEAD, ASIDE = np.array([6.0, 0.0, 0.0]), np.array([0.0, 8.0, np.pi / 2])
BEHIND = np.array([-7.5, 0.0, 0.0])


def wall(x: float) -> Float:
    """Return a wall across the way, 1.5 m high and 6 m wide."""
    y, z = np.meshgrid(np.arange(-3.0, 3.0, 0.1), np.arange(0.0, 1.5, 0.1))
    return np.column_stack([np.full(y.size, x), y.ravel(), z.ravel()])


def planned(
    *goals: Float, points: Float = LEVEL, yaw: float = 0.0, machine: Machine = M545
) -> DrivePlan:
    at = pose(from_rpy(0.0, 0.0, yaw), np.array([0.0, 0.0, M545.stance.base_height_m]))
    request = DriveRequest(at, np.array(goals), Cloud("map", points))
    return Dubins(DubinsSettings(), machine).plan(request)


def test_a_free_way_ahead_is_straight_and_ends_at_the_goal() -> None:
    path = planned(AHEAD).path
    assert path is not None
    np.testing.assert_allclose(path.goal_map, AHEAD, atol=1e-9)
    np.testing.assert_allclose(path.poses_map[:, 1:], 0.0, atol=1e-9)
    assert (path.direction == 1).all()


def test_a_goal_behind_is_reached_backwards() -> None:
    path = planned(BEHIND).path
    assert path is not None
    np.testing.assert_allclose(path.goal_map, BEHIND, atol=1e-9)
    assert (path.direction == -1).all()


def test_a_goal_where_the_machine_stands_is_refused_and_the_next_one_taken() -> None:
    here = np.array([0.0, 0.0, 2 * np.pi])
    plan = planned(here)
    assert plan.path is None
    assert plan.trouble is DriveTrouble.REFUSED
    assert plan.reason == "the machine stands there already"
    path = planned(here, AHEAD).path
    assert path is not None
    np.testing.assert_allclose(path.goal_map, AHEAD, atol=1e-9)


def test_the_first_goal_with_a_free_way_is_taken() -> None:
    blocked = np.vstack([LEVEL, wall(6.0)])
    path = planned(AHEAD, ASIDE, BEHIND, points=blocked).path
    assert path is not None
    np.testing.assert_allclose(path.goal_map, ASIDE, atol=1e-9)


def test_where_all_goals_are_blocked_the_reason_is_that_of_the_first() -> None:
    unseen = np.array([60.0, 0.0, 0.0])
    blocked = np.vstack([LEVEL, wall(6.0)])
    assert planned(AHEAD, unseen, points=blocked).trouble is DriveTrouble.BLOCKED
    assert planned(unseen, AHEAD, points=blocked).trouble is DriveTrouble.UNSEEN


def test_a_machine_that_does_not_drive_is_refused() -> None:
    plan = planned(AHEAD, machine=FIXED)
    assert (plan.path, plan.trouble) == (None, DriveTrouble.REFUSED)
    assert "does not drive" in plan.reason
    path = planned(AHEAD).path
    with pytest.raises(DataError, match="does not drive"):
        Dubins(DubinsSettings(), FIXED).steer(path, 0.0, np.eye(4))
    with pytest.raises(ValueError, match="does not drive"):
        footprint(FIXED, 0.1)


def test_a_machine_on_its_path_steers_along_it() -> None:
    path = planned(AHEAD).path
    assert path is not None
    at = pose(t=np.array([1.0, 0.0, M545.stance.base_height_m]))
    steering = Dubins(DubinsSettings(), M545).steer(path, 0.9, at)
    assert steering.along_m == pytest.approx(1.0, abs=0.06)
    assert steering.speed_m_s > 0.0
    assert steering.curvature_1_m == pytest.approx(0.0, abs=1e-6)
