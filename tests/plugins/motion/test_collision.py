"""The arm against ground and stones."""

import numpy as np
import pytest
from executive_plugins.motion.collision import CollisionCheck
from executive_plugins.motion.obstacles import Obstacles
from executive_plugins.motion.self_collision import SelfCollision, held_body, machine_bodies

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine

OPEN_RAD = 0.9
TOLERANCE_M = 0.05


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


def level(height_m: float) -> Float:
    xy = np.random.default_rng(0).uniform(-9, 9, (40000, 2))
    return np.c_[xy, np.full(len(xy), height_m)]


def check(
    machine: Machine, points: Float, start: Float, held: Float | None = None
) -> CollisionCheck:
    body = None if held is None else held_body(machine, held)
    machine_check = SelfCollision(machine, machine_bodies(machine), 0.05, body)
    return CollisionCheck(machine_check, Obstacles(points, 11.0), start, OPEN_RAD, TOLERANCE_M)


def lowest_m(machine: Machine, q: Float) -> float:
    parts = machine.gripper.hulls(OPEN_RAD)
    corners = np.vstack([hull for hulls in parts.values() for hull in hulls])
    return float(transform(Kinematics(machine).gripper(q), corners)[:, 2].min())


def test_jaws_go_as_deep_into_the_ground_as_they_dig_and_no_deeper(machine: Machine) -> None:
    carry, elsewhere = machine.posture("carry"), machine.posture("scan")
    elsewhere[0] = np.pi
    deepest_m = TOLERANCE_M + machine.gripper.digs_m
    for deep_m, hits in ((deepest_m - 0.02, False), (deepest_m + 0.02, True)):
        ground = level(lowest_m(machine, carry) + deep_m)
        hit = check(machine, ground, elsewhere).first_hit(carry[None])
        assert (hit is not None) is hits


def ball(centre: Float, radius_m: float) -> Float:
    directions = np.random.default_rng(1).normal(size=(2000, 3))
    return np.asarray(centre + radius_m * directions / np.linalg.norm(directions, axis=1)[:, None])


def test_ground_just_below_the_tips_is_free_and_ground_above_them_is_a_hit(
    machine: Machine,
) -> None:
    carry = machine.posture("carry")
    elsewhere = machine.posture("scan")
    elsewhere[0] = np.pi
    below = check(machine, level(lowest_m(machine, carry) - 0.05), elsewhere)
    above = check(machine, level(lowest_m(machine, carry) + 0.25), elsewhere)
    assert below.first_hit(carry[None]) is None
    hit = above.first_hit(np.array([carry]))
    assert hit is not None
    assert "with the ground" in hit.what


def test_says_which_posture_is_the_first_to_hit(machine: Machine) -> None:
    carry, turned = machine.posture("carry"), machine.posture("carry")
    turned[0] = 1.0
    centre = transform(Kinematics(machine).gripper(turned), machine.gripper.grasp_centre)
    q = np.linspace(carry, turned, 21)
    hit = check(machine, np.vstack([level(-3.0), ball(centre, 0.3)]), carry).first_hit(q)
    assert hit is not None
    assert 5 < hit.posture < 20
    assert (
        check(machine, np.vstack([level(-3.0), ball(centre, 0.3)]), carry).first_hit(
            q[: hit.posture]
        )
        is None
    )


def test_a_stone_between_open_jaws_is_no_collision(machine: Machine) -> None:
    carry, away = machine.posture("carry"), machine.posture("carry")
    away[0] = 2.0
    centre = transform(Kinematics(machine).gripper(carry), np.array([0.55, 0.0, 0.0]))
    points = np.vstack([level(-3.0), ball(centre, 0.35)])
    assert check(machine, points, away).first_hit(carry[None]) is None


def test_what_the_machine_touches_at_the_start_is_excused(machine: Machine) -> None:
    carry, away = machine.posture("carry"), machine.posture("carry")
    away[0] = 2.0
    centre = transform(
        Kinematics(machine).gripper(carry), np.array([-0.1, 0.0, 0.0])
    )  # in the palm
    points = np.vstack([level(-3.0), ball(centre, 0.15)])
    assert check(machine, points, carry).first_hit(carry[None]) is None
    assert check(machine, points, away).first_hit(carry[None]) is not None


def test_a_held_stone_hits_what_the_gripper_alone_passes(machine: Machine) -> None:
    carry, away = machine.posture("carry"), machine.posture("carry")
    away[:2] = 2.0, carry[1] + 0.1  # higher: what is in the ground at the start may stay in it
    T = Kinematics(machine).gripper(carry)
    hanging = ball(machine.gripper.grasp_centre, 0.5)
    ground = level(transform(T, hanging)[:, 2].min() + 0.2)
    alone, laden = check(machine, ground, away), check(machine, ground, away, hanging)
    assert alone.first_hit(carry[None]) is None
    hit = laden.first_hit(carry[None])
    assert hit is not None
    assert hit.what.startswith("held_stone")


def test_a_stone_on_the_ground_may_be_lifted_off_it(machine: Machine) -> None:
    carry = machine.posture("carry")
    hanging = ball(machine.gripper.grasp_centre, 0.5)
    ground = level(transform(Kinematics(machine).gripper(carry), hanging)[:, 2].min() + 0.04)
    lift = carry + np.linspace(0.0, 0.1, 5)[:, None] * (np.array(machine.arm_names) == "J_BOOM")
    assert check(machine, ground, carry, hanging).first_hit(lift) is None


def test_chassis_and_cabin_may_stand_among_points(machine: Machine) -> None:
    around = ball(np.array([0.0, 0.0, 0.5]), 1.0)
    assert (
        check(machine, around, machine.posture("carry")).first_hit(machine.posture("carry")[None])
        is None
    )


def test_the_load_is_checked_against_the_machine(machine: Machine) -> None:
    carry = machine.posture("carry")
    T = Kinematics(machine).gripper(carry)
    cabin_gripper = transform(np.linalg.inv(T), ball(np.array([0.3, 0.5, 1.5]), 0.4))
    hit = check(machine, np.zeros((0, 3)), carry, cabin_gripper).machine_hit(carry[None])
    assert hit is not None
    assert "held_stone" in hit.what
