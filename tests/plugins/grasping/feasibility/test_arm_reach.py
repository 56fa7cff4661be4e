"""Whether the arm reaches a pose of the gripper in the map, and may lift a stone there."""

import numpy as np
import pytest
from executive_plugins.grasping.feasibility.arm_reach import ArmReach

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine

T_MAP_BASE = pose(from_rpy(0.0, 0.0, 0.7), np.array([3.0, -2.0, 0.5]))


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


class Motion:
    """Reaches poses in the base frame up to a height, each in its own posture.

    Attributes:
        asked: Poses that were asked for.
    """

    def __init__(self, machine: Machine, highest_m: float = 9.0, turned: float = 0.0) -> None:
        self.machine, self.highest_m, self.turned = machine, highest_m, turned
        self.asked: list[Float] = []

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        np.testing.assert_array_equal(seed, self.machine.posture("carry"))
        self.asked.append(T_base_gripper)
        if T_base_gripper[2, 3] > self.highest_m:
            return None
        q = seed.copy()
        q[-1] += self.turned if T_base_gripper[1, 1] > 0 else 0.5
        return q


def test_a_stone_is_held_where_the_joints_can_and_nowhere_out_of_reach(machine: Machine) -> None:
    T_map_gripper = T_MAP_BASE @ Kinematics(machine).gripper(machine.posture("carry"))
    motion = Motion(machine)
    reach = ArmReach(machine, motion)  # type: ignore[arg-type]
    assert reach.holds(T_map_gripper, T_MAP_BASE, 100.0)
    assert not reach.holds(T_map_gripper, T_MAP_BASE, 1e6)
    np.testing.assert_allclose(motion.asked[0], inverse(T_MAP_BASE) @ T_map_gripper, atol=1e-12)
    motion.highest_m = -99.0
    assert not reach.holds(T_map_gripper, T_MAP_BASE, 0.0)


def test_a_lift_is_refused_with_its_reason(machine: Machine) -> None:
    T_map_gripper = T_MAP_BASE @ Kinematics(machine).gripper(machine.posture("carry"))
    motion = Motion(machine)
    reach = ArmReach(machine, motion)  # type: ignore[arg-type]
    assert reach.refusal(T_map_gripper, T_MAP_BASE, 100.0) == ""
    np.testing.assert_allclose(motion.asked[0], inverse(T_MAP_BASE) @ T_map_gripper, atol=1e-12)
    told = reach.refusal(T_map_gripper, T_MAP_BASE, 1e6)
    assert told
    assert told == reach._capacity.at(machine.posture("carry")).refusal(1e6)
    motion.highest_m = -99.0
    assert reach.refusal(T_map_gripper, T_MAP_BASE, 0.0) == "out of reach"


@pytest.mark.parametrize(("turned", "is_turned"), [(0.4, False), (0.5, False), (0.6, True)])
def test_of_a_pose_and_its_half_turn_that_which_turns_the_wrist_less_is_taken(
    machine: Machine, turned: float, is_turned: bool
) -> None:
    reach = ArmReach(machine, Motion(machine, turned=turned))  # type: ignore[arg-type]
    T = pose(t=np.array([4.0, 1.0, 1.0]))
    found = reach.reached(T, np.eye(4), 0.8)
    assert found is not None
    sign = -1.0 if is_turned else 1.0
    np.testing.assert_allclose(found[:3, :3], np.diag([1.0, sign, sign]), atol=1e-12)


def test_the_point_above_must_be_in_reach_too(machine: Machine) -> None:
    T = pose(t=np.array([4.0, 1.0, 1.0]))
    for highest_m, is_reached in ((1.7, False), (1.9, True), (0.9, False)):
        motion = Motion(machine, highest_m)
        found = ArmReach(machine, motion).reached(T, np.eye(4), 0.8)  # type: ignore[arg-type]
        assert (found is not None) is is_reached
