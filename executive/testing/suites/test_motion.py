"""What every motion planner must do, whatever its method."""

import numpy as np
import pytest

from executive.interfaces.motion import MotionPlanner
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.request import PostureRequest
from executive.testing.exercises.motion import beside, ground, request
from executive.testing.pytest_plugin import Insist

CAPABILITY = "motion"


def test_reach_reaches(plugin: MotionPlanner, machine: Machine, insist: Insist) -> None:
    T = beside(machine, 1.0)
    q = plugin.reach(T, machine.posture("carry"))
    insist(q is not None, "it reaches no pose beside the machine")
    assert q is not None
    np.testing.assert_allclose(Kinematics(machine).gripper(q), T, atol=0.02)


def test_reach_refuses_what_is_out_of_reach(plugin: MotionPlanner, machine: Machine) -> None:
    far = beside(machine, 0.0) + 0.0
    far[0, 3] += 3 * machine.reach_m
    assert plugin.reach(far, machine.posture("carry")) is None


def test_a_move_leads_from_the_start_to_the_goal_within_all_limits(
    plugin: MotionPlanner, machine: Machine, insist: Insist
) -> None:
    goal = beside(machine, 1.2)
    plan = plugin.move(request(machine, goal))
    insist(plan.trajectory is not None, plan.reason)
    assert plan.trajectory is not None
    assert plan.reason == ""
    trajectory = plan.trajectory
    assert trajectory.names == machine.arm_names
    np.testing.assert_allclose(trajectory.position[0], machine.posture("carry"), atol=1e-6)
    np.testing.assert_allclose(
        Kinematics(machine).gripper(trajectory.position[-1]), goal, atol=0.02
    )
    np.testing.assert_allclose(trajectory.velocity[[0, -1]], 0.0, atol=1e-9)
    assert (np.abs(trajectory.velocity) <= machine.max_velocity + 1e-9).all()
    assert (
        (trajectory.position >= machine.lower - 1e-6)
        & (trajectory.position <= machine.upper + 1e-6)
    ).all()
    np.testing.assert_allclose(plan.path_map[0], beside(machine, 0.0)[:3, 3], atol=1e-6)


def test_a_move_into_the_ground_is_refused_with_a_reason(
    plugin: MotionPlanner, machine: Machine
) -> None:
    goal = beside(machine, 1.2)
    goal[2, 3] = -machine.stance.base_height_m - 0.3
    plan = plugin.move(request(machine, goal))
    assert plan.trajectory is None
    assert plan.reason


def test_a_move_out_of_reach_is_refused_with_a_reason(
    plugin: MotionPlanner, machine: Machine
) -> None:
    goal = beside(machine, 1.2)
    goal[:2, 3] *= 4
    plan = plugin.move(request(machine, goal))
    assert plan.trajectory is None
    assert plan.reason


def test_a_swing_turns_the_cabin_to_both_sides_and_lasts(
    plugin: MotionPlanner, machine: Machine, insist: Insist
) -> None:
    start = machine.posture("scan")
    plan = plugin.swing(start, 1.0, 12.0)
    insist(plan.trajectory is not None, plan.reason)
    assert plan.trajectory is not None
    turn = plan.trajectory.position[:, machine.arm_names.index(machine.turn_joint)]
    assert (turn.max(), turn.min(), turn[-1]) == pytest.approx((0.5, -0.5, 0.0), abs=1e-3)
    assert plan.trajectory.duration_s >= 12.0


def test_a_motion_to_joint_positions_ends_there_or_is_refused_with_a_reason(
    plugin: MotionPlanner, machine: Machine
) -> None:
    turn = machine.arm_names.index(machine.turn_joint)
    start, goal = machine.posture("carry"), machine.posture("scan")
    goal[turn] += 0.8
    asked = PostureRequest(start, goal, np.eye(4), ground(machine), None, 0.3)
    plan = plugin.move_joints(asked)
    assert (plan.trajectory is None) == bool(plan.reason)
    if plan.trajectory is None:
        return
    position, velocity = plan.trajectory.position, plan.trajectory.velocity
    np.testing.assert_allclose(position[0], start, atol=1e-6)
    away = position[-1] - goal
    away -= 2 * np.pi * np.where(np.isfinite(machine.lower), 0.0, np.round(away / (2 * np.pi)))
    np.testing.assert_allclose(away, 0.0, atol=1e-3)
    np.testing.assert_allclose(velocity[[0, -1]], 0.0, atol=1e-9)
    assert (np.abs(velocity) <= machine.max_velocity + 1e-9).all()
