"""Limits of the joints with what the held stone weighs."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.motion.hermite import Hermite
from executive_plugins.motion.settings import HermiteSettings

from executive.arrays import Float
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MoveRequest, PostureRequest

M545 = load_machine("m545")
SHARE = HermiteSettings().speed


@pytest.fixture(scope="module")
def planner() -> Hermite:
    started = Hermite(HermiteSettings(load_limits="by_mass"), M545)
    started.start()
    return started


@pytest.fixture(scope="module")
def asked() -> PostureRequest:
    """A turn with a stone, above nothing."""
    start = M545.posture("carry")
    turned = start.copy()
    turned[0] += 1.5
    stone = np.random.default_rng(1).normal([0.8, 0.0, 0.0], 0.1, (50, 3))
    return PostureRequest(start, turned, np.eye(4), Cloud("map", np.zeros((0, 3))), stone, 0.3)


def most(planner: Hermite, asked: PostureRequest) -> tuple[Float, float]:
    plan = planner.move_joints(asked)
    assert plan.trajectory is not None, plan.reason
    return np.abs(plan.trajectory.velocity).max(axis=0), plan.trajectory.duration_s


def test_a_heavier_stone_is_carried_more_slowly(planner: Hermite, asked: PostureRequest) -> None:
    at = {
        share: most(planner, replace(asked, held_kg=share * M545.payload_kg))
        for share in (0.0, 0.5, 1.0)
    }
    assert at[0.0][1] <= at[0.5][1] < at[1.0][1]
    for share, (speeds, _) in at.items():
        limit = (1 - share) * M545.max_velocity + share * M545.loaded_max_velocity
        assert (speeds <= SHARE * limit + 1e-9).all()


def test_an_unknown_mass_has_the_loaded_limits(planner: Hermite, asked: PostureRequest) -> None:
    heavy = replace(asked, held_kg=2 * M545.payload_kg)
    assert most(planner, asked)[1] == most(planner, heavy)[1]


def test_by_default_the_mass_changes_nothing(make_planner, asked: PostureRequest) -> None:
    light = replace(asked, held_kg=100.0)
    assert most(make_planner("m545"), asked)[1] == most(make_planner("m545"), light)[1]


@pytest.mark.parametrize("settings", [{}, {"held_up_m_s2": 0.2, "held_sideways_m_s2": 0.4}])
def test_no_joint_accelerates_a_held_stone_by_more_than_is_set(
    asked: PostureRequest, settings: dict[str, float]
) -> None:
    """Straight up, and around; what the joints add to each other is not limited."""
    chosen, kinematics = HermiteSettings(**settings), Kinematics(M545)
    planner = Hermite(chosen, M545)
    planner.start()
    for plan in (planner.move(raised(asked)), planner.move_joints(asked)):
        assert plan.trajectory is not None, plan.reason
        q, speeds, times_s = (
            getattr(plan.trajectory, n) for n in ("position", "velocity", "times_s")
        )
        accelerations = np.abs(np.diff(speeds, axis=0) / np.diff(times_s)[:, None])
        J = np.array([kinematics.jacobian(one) for one in (q[0], q[-1])])
        up, sideways = np.abs(J[:, 2]).max(axis=0), np.linalg.norm(J[:, :2], axis=1).max(axis=0)
        assert (accelerations * up).max() <= 1.02 * chosen.held_up_m_s2
        assert (accelerations * sideways).max() <= 1.02 * chosen.held_sideways_m_s2


def test_an_empty_gripper_is_raised_faster_than_a_stone(
    make_planner, asked: PostureRequest
) -> None:
    planner, up = make_planner("m545"), raised(asked)
    empty_s, held_s = (
        planner.move(replace(up, held_gripper=held)).trajectory.duration_s
        for held in (None, up.held_gripper)
    )
    assert held_s > 1.1 * empty_s


def raised(asked: PostureRequest) -> MoveRequest:
    """Return the way straight up from the start, by a metre."""
    goal = Kinematics(M545).gripper(asked.start)
    goal[2, 3] += 1.0
    return MoveRequest(
        asked.start, goal, np.eye(4), 1.0, 0.0, asked.obstacles, asked.held_gripper, asked.jaw_rad
    )
