"""The machine against itself and against its load."""

import numpy as np
import pytest
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.self_collision import SelfCollision, held_body, machine_bodies

from executive.machine.machine import load_machine


def ball(centre_m: tuple[float, float, float], radius_m: float) -> np.ndarray:
    directions = np.random.default_rng(0).normal(size=(400, 3))
    return centre_m + radius_m * directions / np.linalg.norm(directions, axis=1)[:, None]


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_the_named_postures_are_free(model: str) -> None:
    machine = load_machine(model)
    check = SelfCollision(machine, machine_bodies(machine), 0.05)
    q = np.array([machine.posture(name) for name in machine.postures])
    assert check.first_hit(link_frames(machine, q, machine.gripper.open_rad)) is None


def test_a_gripper_folded_into_the_cabin_is_a_hit_and_named() -> None:
    machine = load_machine("m545")
    folded = machine.posture("scan")
    for joint, value in {
        "J_BOOM": 0.4,
        "J_DIPPER": -1.1,
        "J_TELE": 0.3,
        "J_EE_PITCH": -2.2,
    }.items():
        folded[machine.arm_names.index(joint)] = value
    q = np.linspace(machine.posture("scan"), folded, 40)
    hit = SelfCollision(machine, machine_bodies(machine), 0.05).first_hit(
        link_frames(machine, q, 0.9)
    )
    assert hit is not None
    assert hit[0] > 0
    assert {"cabin", "base", "boom"} & set(hit[1:])


def test_a_stone_that_reaches_up_to_the_boom_is_a_hit() -> None:
    machine = load_machine("m545")
    frames = link_frames(machine, machine.posture("carry")[None], 0.5)
    small = held_body(machine, ball((0.75, 0.0, 0.0), 0.4))
    large = held_body(machine, ball((0.75, 0.0, 0.0), 2.5))
    assert SelfCollision(machine, machine_bodies(machine), 0.05, small).first_hit(frames) is None
    hit = SelfCollision(machine, machine_bodies(machine), 0.05, large).first_hit(frames)
    assert hit is not None
    assert "held_stone" in hit[1:]


def test_the_hull_of_a_held_stone_loses_no_more_than_a_centimetre_or_so() -> None:
    machine = load_machine("m545")
    points = ball((0.75, 0.0, 0.0), 0.5)
    assert held_body(machine, points).depths(points).min() > -0.02
