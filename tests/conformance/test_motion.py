"""What every motion planner must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.motion import MotionPlanner
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest


@pytest.fixture(scope="module", params=["m545", "mini"])
def machine(request: pytest.FixtureRequest) -> Machine:
    return load_machine(request.param)


@pytest.fixture(scope="module", params=[plugin.name for plugin in registry.installed("motion")])
def planner(request: pytest.FixtureRequest, machine: Machine) -> Iterator[MotionPlanner]:
    plugin = registry.load("motion", request.param)
    services = {"machine": machine, "rng": np.random.default_rng(0)}
    planner = plugin(
        plugin.Settings(), *[services[name] for name in registry.dependencies_of(plugin)]
    )
    planner.start()
    yield planner
    planner.close()


def beside(machine: Machine, angle_rad: float) -> Float:
    """Return the carrying pose, turned about the machine: T_base_gripper."""
    return pose(from_rpy(0.0, 0.0, angle_rad)) @ Kinematics(machine).gripper(
        machine.posture("carry")
    )


def ground(machine: Machine) -> Cloud:
    xy = np.random.default_rng(0).uniform(-9, 9, (30000, 2))
    return Cloud("map", np.c_[xy, np.full(len(xy), -machine.stance.base_height_m)])


def ask(planner: MotionPlanner, machine: Machine, goal: Float) -> MotionPlan:
    start = machine.posture("carry")
    return planner.move(MoveRequest(start, goal, np.eye(4), 0.2, 0.2, ground(machine), None, 0.3))


def test_it_is_a_motion_planner(planner: MotionPlanner) -> None:
    assert isinstance(planner, MotionPlanner)


def test_reach_reaches(planner: MotionPlanner, machine: Machine) -> None:
    T = beside(machine, 1.0)
    q = planner.reach(T, machine.posture("carry"))
    assert q is not None
    np.testing.assert_allclose(Kinematics(machine).gripper(q), T, atol=0.02)


def test_reach_refuses_what_is_out_of_reach(planner: MotionPlanner, machine: Machine) -> None:
    far = beside(machine, 0.0) + 0.0
    far[0, 3] += 3 * machine.reach_m
    assert planner.reach(far, machine.posture("carry")) is None


def test_a_move_leads_from_the_start_to_the_goal_within_all_limits(
    planner: MotionPlanner, machine: Machine
) -> None:
    goal = beside(machine, 1.2)
    plan = ask(planner, machine, goal)
    assert plan.trajectory is not None, plan.reason
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
    planner: MotionPlanner, machine: Machine
) -> None:
    goal = beside(machine, 1.2)
    goal[2, 3] = -machine.stance.base_height_m - 0.3
    plan = ask(planner, machine, goal)
    assert plan.trajectory is None
    assert plan.reason


def test_a_move_out_of_reach_is_refused_with_a_reason(
    planner: MotionPlanner, machine: Machine
) -> None:
    goal = beside(machine, 1.2)
    goal[:2, 3] *= 4
    plan = ask(planner, machine, goal)
    assert plan.trajectory is None
    assert plan.reason


def test_a_swing_turns_the_cabin_to_both_sides_and_lasts(
    planner: MotionPlanner, machine: Machine
) -> None:
    start = machine.posture("scan")
    plan = planner.swing(start, 1.0, 12.0)
    assert plan.trajectory is not None, plan.reason
    turn = plan.trajectory.position[:, machine.arm_names.index(machine.turn_joint)]
    assert (turn.max(), turn.min(), turn[-1]) == pytest.approx((0.5, -0.5, 0.0), abs=1e-3)
    assert plan.trajectory.duration_s >= 12.0


def test_equal_requests_have_equal_answers(planner: MotionPlanner, machine: Machine) -> None:
    first, second = (ask(planner, machine, beside(machine, -0.8)) for _ in range(2))
    assert first.trajectory is not None
    assert second.trajectory is not None
    np.testing.assert_array_equal(first.trajectory.position, second.trajectory.position)
