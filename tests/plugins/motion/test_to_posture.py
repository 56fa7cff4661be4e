"""Motions to joint positions: direct where that is free, else around what stands in the way."""

import numpy as np
import pytest

from executive.errors import ShapeError
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import PostureRequest
from executive.testing.stand_ins import FreeMotion

NOTHING = Cloud("map", np.zeros((0, 3)))


def asked(start, goal, points=None, held=None):
    obstacles = NOTHING if points is None else Cloud("map", points)
    return PostureRequest(start, goal, np.eye(4), obstacles, held, 0.3)


def turned(machine, posture, turn_rad):
    q = machine.posture(posture)
    q[machine.arm_names.index(machine.turn_joint)] = turn_rad
    return q


def block(azimuth_rad, radius_m, top_m):
    """Return points of a pillar beside the machine, from the ground to a height of the base."""
    x, y, z = np.meshgrid(*[np.arange(-0.4, 0.41, 0.1)] * 2, np.arange(-0.9, top_m, 0.1))
    centre = radius_m * np.array([np.cos(azimuth_rad), np.sin(azimuth_rad), 0.0])
    return np.stack([x, y, z], axis=-1).reshape(-1, 3) + centre


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_all_joints_arrive_at_once_within_their_limits(make_planner, model) -> None:
    machine = load_machine(model)
    start, goal = turned(machine, "carry", 0.0), turned(machine, "scan", 1.0)
    plan = make_planner(model).move_joints(asked(start, goal))
    assert plan.trajectory is not None, plan.reason
    np.testing.assert_allclose(plan.trajectory.position[[0, -1]], [start, goal], atol=1e-6)
    assert (np.abs(plan.trajectory.velocity) <= machine.max_velocity + 1e-9).all()


def test_a_continuous_joint_takes_the_shorter_way(make_planner) -> None:
    machine = load_machine("m545")
    turn = machine.arm_names.index(machine.turn_joint)
    start, goal = turned(machine, "carry", 3.0), turned(machine, "carry", -3.0)
    plan = make_planner("m545").move_joints(asked(start, goal))
    assert plan.trajectory is not None, plan.reason
    assert np.ptp(plan.trajectory.position[:, turn]) == pytest.approx(2 * np.pi - 6.0, abs=1e-3)


def test_a_stone_in_the_way_is_passed_above(make_planner) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    start, goal = turned(machine, "carry", -0.8), turned(machine, "carry", 0.8)
    free = planner.move_joints(asked(start, goal))
    radius_m = float(np.hypot(*free.path_map[0, :2]))
    lowest_m = float(free.path_map[:, 2].min())
    plan = planner.move_joints(asked(start, goal, block(0.0, radius_m, lowest_m - 0.7)))
    assert free.trajectory is not None
    assert plan.trajectory is not None, plan.reason
    assert plan.path_map[:, 2].max() > free.path_map[:, 2].max() + 0.2
    np.testing.assert_allclose(plan.trajectory.position[-1], goal, atol=1e-6)


def test_a_goal_beyond_a_joints_range_is_refused_with_the_range(make_planner) -> None:
    machine = load_machine("m545")
    goal = machine.posture("carry")
    goal[machine.arm_names.index("J_BOOM")] = 5.0
    plan = make_planner("m545").move_joints(asked(machine.posture("carry"), goal))
    assert plan.trajectory is None
    assert plan.reason.startswith("J_BOOM to 5.00: the range of J_BOOM is")


def test_a_goal_inside_the_ground_is_refused(make_planner) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    xy = np.random.default_rng(0).uniform(-9, 9, (30000, 2))
    ground = np.c_[xy, np.full(len(xy), -0.9)]
    goal = machine.posture("carry")
    goal[machine.arm_names.index("J_BOOM")] = machine.joints[1].lower
    plan = planner.move_joints(asked(machine.posture("carry"), goal, ground))
    assert plan.trajectory is None
    assert "collision of" in plan.reason


def test_a_start_of_another_arm_is_refused(make_planner) -> None:
    with pytest.raises(ShapeError, match=r"shape \(5,\), expected \(7\)"):
        make_planner("m545").move_joints(asked(np.zeros(5), np.zeros(5)))


def test_a_planner_without_the_verb_refuses_with_its_name() -> None:
    plan = FreeMotion().move_joints(asked(np.zeros(7), np.zeros(7)))
    assert plan.trajectory is None
    assert plan.reason == "FreeMotion plans no motion to joint positions"
