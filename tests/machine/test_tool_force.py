"""The force on the tool by the efforts of the joints, and the moments by which it tips."""

import numpy as np
import pytest

from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.machine.tipping_moment import TippingMoment
from executive.machine.tool_force import ToolForce

M545 = load_machine("m545")
SCAN, CARRY = M545.posture("scan"), M545.posture("carry")


def efforts(q: np.ndarray, force_n: np.ndarray, at_gripper: np.ndarray) -> np.ndarray:
    """Return the efforts that hold the arm against a force on the gripper, by virtual work."""
    kinematics, step = Kinematics(M545), 1e-6
    ends = [
        [transform(kinematics.gripper(q + sign * one), at_gripper) for sign in (1, -1)]
        for one in step * np.eye(len(q))
    ]
    return -np.array([force_n @ (plus - minus) / (2 * step) for plus, minus in ends])


@pytest.mark.parametrize("q", [SCAN, CARRY])
@pytest.mark.parametrize("force_n", [[0.0, 0.0, 30e3], [20e3, 0.0, 0.0], [-4e3, 9e3, 12e3]])
def test_a_force_at_the_grasp_centre_is_told_by_the_efforts(q, force_n) -> None:
    effort = efforts(q, np.array(force_n), np.array(M545.gripper.grasp_centre))
    assert ToolForce(M545).explaining(q, effort) == pytest.approx(np.array(force_n), abs=1.0)


@pytest.mark.parametrize("aside_m", [-0.5, 0.5])
def test_a_force_at_a_tip_is_told_to_a_fifth(aside_m: float) -> None:
    """Where between the tips it acts is not known."""
    force_n, tip = np.array([0.0, 0.0, 30e3]), np.array(M545.gripper.grasp_centre)
    effort = efforts(SCAN, force_n, tip + [0.0, aside_m, 0.0])
    assert ToolForce(M545).explaining(SCAN, effort) == pytest.approx(force_n, abs=6e3)


def test_a_weight_tips_the_machine_by_what_it_takes_from_what_holds_it() -> None:
    moment, weight_n = TippingMoment(M545), np.array([0.0, 0.0, -9.80665 * 1000.0])
    taken = moment.holding_nm(CARRY, 0.0) - moment.holding_nm(CARRY, 1000.0)
    assert moment.tipping_nm(CARRY, weight_n) == pytest.approx(taken, rel=1e-3)


def test_a_push_aside_tips_by_its_height_about_the_side_that_it_points_to() -> None:
    moment, push_n = TippingMoment(M545), np.array([10e3, 0.0, 0.0])
    tool = transform(Kinematics(M545).gripper(CARRY), M545.gripper.grasp_centre)
    height_m = tool[2] + M545.stance.base_height_m
    assert moment.tipping_nm(CARRY, push_n).max() == pytest.approx(10e3 * height_m, rel=1e-6)
