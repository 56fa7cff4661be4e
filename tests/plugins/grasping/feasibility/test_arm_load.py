"""Static efforts against moments that can be taken by hand."""

import numpy as np
import pytest
from executive_plugins.grasping.feasibility.arm_load import ArmLoad

from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine


def test_a_load_adds_its_weight_times_its_distance_to_the_boom(machine: Machine) -> None:
    q = machine.posture("carry")
    boom = machine.arm_names.index("J_BOOM")
    added = ArmLoad(machine).efforts(q, 1000.0) - ArmLoad(machine).efforts(q, 0.0)
    frames = Kinematics(machine).frames(q)
    arm_m = transform(frames["gripper"], machine.gripper.grasp_centre) - frames["boom"][:3, 3]
    axis = frames["boom"][:3, 1]  # the boom turns about its y
    assert abs(added[boom]) == pytest.approx(
        abs(1000 * 9.81 * np.cross(arm_m, [0, 0, -1]) @ axis), rel=1e-4
    )


def test_the_cabin_turns_about_an_upright_axis_and_carries_nothing(machine: Machine) -> None:
    turn = machine.arm_names.index(machine.turn_joint)
    assert ArmLoad(machine).efforts(machine.posture("carry"), 3000.0)[turn] == pytest.approx(
        0.0, abs=1.0
    )


def test_the_arm_holds_its_payload_and_not_ten_times_it(machine: Machine) -> None:
    load, q = ArmLoad(machine), machine.posture("carry")
    assert load.can_hold(q, machine.payload_kg)
    assert not load.can_hold(q, 10 * machine.payload_kg)
