"""Inverse kinematics against forward kinematics."""

import numpy as np
import pytest
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.settings import InverseKinematicsSettings

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine

DOWN = from_rpy(0.0, np.pi / 2, 0.0)  # the gripper's x axis points down


class Solver:
    """A machine with what a test asks of it."""

    def __init__(self, model: str) -> None:
        self.machine: Machine = load_machine(model)
        self.kinematics = Kinematics(self.machine)
        self.ik = InverseKinematics(InverseKinematicsSettings(), self.machine, self.kinematics)
        self.carry: Float = self.machine.posture("carry")

    def random_postures(self, count: int) -> Float:
        lower, upper = np.maximum(self.machine.lower, -np.pi), np.minimum(self.machine.upper, np.pi)
        return np.random.default_rng(0).uniform(lower, upper, (count, len(lower)))


@pytest.fixture(scope="module")
def m545() -> Solver:
    return Solver("m545")


@pytest.fixture(scope="module")
def mini() -> Solver:
    return Solver("mini")


def test_reaches_nearly_all_of_a_thousand_reachable_poses(m545: Solver) -> None:
    reached = 0
    for posture in m545.random_postures(1000):
        T = m545.kinematics.gripper(posture)
        q = m545.ik.solve(T, m545.carry)
        if q is None:
            continue
        reached += 1
        np.testing.assert_allclose(m545.kinematics.gripper(q)[:3, 3], T[:3, 3], atol=5e-3)
        assert angle_between(m545.kinematics.gripper(q)[:3, :3], T[:3, :3]) < 0.06
    assert reached >= 990


def test_stays_within_the_joints_ends(m545: Solver) -> None:
    for posture in m545.random_postures(200):
        q = m545.ik.solve(m545.kinematics.gripper(posture), m545.carry)
        assert q is None or ((q >= m545.machine.lower) & (q <= m545.machine.upper)).all()


def test_returns_continuous_joints_on_the_turn_nearest_to_the_seed(m545: Solver) -> None:
    seed = m545.carry.copy()
    turn = m545.machine.arm_names.index(m545.machine.turn_joint)
    seed[turn] = 4 * np.pi + 0.3
    q = m545.ik.solve(m545.kinematics.gripper(m545.carry), seed)
    assert q is not None
    assert q[turn] == pytest.approx(4 * np.pi, abs=1e-3)
    assert abs(q[-1] - seed[-1]) <= np.pi


def test_moves_no_joint_to_an_end_where_the_telescope_leaves_freedom(m545: Solver) -> None:
    machine = m545.machine
    q = m545.ik.solve(pose(DOWN, np.array([5.5, -0.28, 0.0])), m545.carry)
    assert q is not None
    bounded = np.isfinite(machine.lower)
    share = (q - machine.lower)[bounded] / (machine.upper - machine.lower)[bounded]
    assert ((share > 0.03) & (share < 0.97)).all()


def test_refuses_what_is_too_far_away(m545: Solver) -> None:
    assert m545.ik.solve(pose(DOWN, np.array([9.5, 0.0, 0.0])), m545.carry) is None
    assert m545.ik.solve(pose(DOWN, np.array([30.0, 0.0, 0.0])), m545.carry) is None


def test_refuses_a_gripper_that_looks_up(m545: Solver) -> None:
    assert (
        m545.ik.solve(pose(from_rpy(0.0, -np.pi / 2, 0.0), np.array([5.5, 0.0, 0.0])), m545.carry)
        is None
    )


def test_asks_the_further_demand_of_each_solution(m545: Solver) -> None:
    seen: list[Float] = []

    def refuse(q: Float) -> bool:
        seen.append(q)
        return False

    assert m545.ik.solve(m545.kinematics.gripper(m545.carry), m545.carry, refuse) is None
    assert seen


def test_five_joints_reach_every_vertical_pick_in_their_ring(mini: Solver) -> None:
    for azimuth, radius, yaw in np.random.default_rng(0).uniform(
        [-3, 2.3, -3], [3, 4.8, 3], (100, 3)
    ):
        place = np.array([radius * np.cos(azimuth), radius * np.sin(azimuth), 0.2])
        T = pose(from_rpy(0.0, 0.0, yaw) @ DOWN, place)
        q = mini.ik.solve(T, mini.carry)
        assert q is not None
        np.testing.assert_allclose(mini.kinematics.gripper(q), T, atol=2e-3)


def test_five_joints_ignore_a_small_tilt_they_cannot_make_and_refuse_a_large_one(
    mini: Solver,
) -> None:
    place = np.array([4.0, 0.0, 0.2])
    assert mini.ik.solve(pose(from_rpy(0.04, 0.0, 0.0) @ DOWN, place), mini.carry) is not None
    assert mini.ik.solve(pose(from_rpy(0.2, 0.0, 0.0) @ DOWN, place), mini.carry) is None


def test_tracking_takes_the_solution_next_to_the_posture(m545: Solver) -> None:
    for posture in m545.random_postures(50):
        inner = np.clip(posture, m545.machine.lower + 0.1, m545.machine.upper - 0.1)
        T = m545.kinematics.gripper(inner)
        q = m545.ik.track(pose(t=np.array([0.0, 0.0, 0.01])) @ T, inner)
        assert q is None or np.abs(q - inner).max() < 0.2
