"""Straight lines, lifts, and turns of the cabin."""

from copy import copy
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.settings import InverseKinematicsSettings
from executive_plugins.motion.waypoints import Line, Waypoints, join, reach_below_m

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine

UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="module")
def waypoints(machine: Machine) -> Waypoints:
    kinematics = Kinematics(machine)
    return Waypoints(
        machine, kinematics, InverseKinematics(InverseKinematicsSettings(), machine, kinematics)
    )


def test_a_line_is_straight_and_keeps_the_orientation(
    machine: Machine, waypoints: Waypoints
) -> None:
    direction = np.array([0.2, 0.1, 1.0]) / np.linalg.norm([0.2, 0.1, 1.0])
    line = waypoints.line_up(machine.posture("carry"), direction, 1.0)
    poses = np.array([Kinematics(machine).gripper(q) for q in line.nodes])
    offsets = poses[:, :3, 3] - poses[0, :3, 3]
    np.testing.assert_allclose(offsets - np.outer(offsets @ direction, direction), 0.0, atol=1e-3)
    assert offsets[-1] @ direction == pytest.approx(1.0, abs=1e-3)
    assert line.length_m == 1.0
    assert max(angle_between(T[:3, :3], poses[0, :3, :3]) for T in poses) < 1e-2


def test_a_line_ends_where_the_reach_ends_and_says_how_long_it_is(
    machine: Machine, waypoints: Waypoints
) -> None:
    line = waypoints.line_up(machine.posture("carry"), UP, 9.0)
    climbed = (
        Kinematics(machine).gripper(line.nodes[-1])[2, 3]
        - Kinematics(machine).gripper(line.nodes[0])[2, 3]
    )
    assert 0.5 < line.length_m < 9.0
    assert climbed == pytest.approx(line.length_m, abs=0.01)


def test_a_line_of_no_length_is_its_low_end(machine: Machine, waypoints: Waypoints) -> None:
    np.testing.assert_array_equal(
        waypoints.line_up(machine.posture("carry"), UP, 0.0).nodes, [machine.posture("carry")]
    )


def test_a_lift_comes_to_its_height_on_the_same_azimuth(
    machine: Machine, waypoints: Waypoints
) -> None:
    start = Kinematics(machine).gripper(machine.posture("carry"))
    q = waypoints.lift(machine.posture("carry"), start[2, 3] + 0.7)
    assert q is not None
    lifted = Kinematics(machine).gripper(q)
    assert lifted[2, 3] == pytest.approx(start[2, 3] + 0.7, abs=0.06)
    assert np.arctan2(lifted[1, 3], lifted[0, 3]) == pytest.approx(
        np.arctan2(start[1, 3], start[0, 3]), abs=0.01
    )


def test_a_lift_beyond_reach_goes_as_high_as_it_can_and_no_lift_is_none(
    machine: Machine, waypoints: Waypoints
) -> None:
    carry = machine.posture("carry")
    height_m = Kinematics(machine).gripper(carry)[2, 3]
    highest = waypoints.lift(carry, 50.0)
    assert highest is not None
    assert Kinematics(machine).gripper(highest)[2, 3] > height_m + 1.0
    assert waypoints.lift(carry, height_m) is None
    assert waypoints.lift(carry, height_m - 1.0) is None


def test_a_lift_that_is_out_of_reach_moves_towards_the_carrying_radius(
    machine: Machine, waypoints: Waypoints
) -> None:
    """Straight up from 6.5 m the gripper comes to 3.7 m; drawn in, it comes to 5.3 m."""
    kinematics = Kinematics(machine)
    down = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    ik = InverseKinematics(InverseKinematicsSettings(), machine, kinematics)
    start = ik.solve(pose(down, np.array([6.5, 0.0, 0.5])), machine.posture("carry"))
    assert start is not None
    highest = waypoints.lift(start, 6.0)
    assert highest is not None
    T = kinematics.gripper(highest)
    assert T[2, 3] > 5.0
    assert np.hypot(*T[:2, 3]) < 5.5
    assert T[1, 3] == pytest.approx(0.0, abs=0.05)


def test_the_other_way_round_is_a_whole_turn_apart(machine: Machine, waypoints: Waypoints) -> None:
    here, there = machine.posture("carry"), machine.posture("carry")
    there[0] = 1.0
    assert waypoints.turn_shifts(here, there) == [0.0, -2 * np.pi]
    assert waypoints.turn_shifts(there, here) == [0.0, 2 * np.pi]
    np.testing.assert_allclose(
        waypoints.shifted(there[None], 0.5)[0], there + [0.5, 0, 0, 0, 0, 0, 0]
    )


def test_joining_runs_up_the_one_line_and_down_the_other() -> None:
    leave, arrive = (
        Line(np.array([[0.0], [1.0], [2.0]]), 1.0),
        Line(np.array([[9.0], [8.0], [7.0]]), 1.0),
    )
    nodes, is_dense = join(leave, [np.array([4.0])], arrive)
    np.testing.assert_array_equal(nodes[:, 0], [0, 1, 2, 4, 7, 8, 9])
    np.testing.assert_array_equal(is_dense, [True, False, False, False, False, True])


def test_hang_is_the_depth_of_the_lowest_point(machine: Machine) -> None:
    T = Kinematics(machine).gripper(machine.posture("carry"))
    assert reach_below_m(T, np.array([[0.0, 0.0, 0.0], [1.2, 0.0, 0.0]])) == pytest.approx(
        -1.2 * T[2, 0], abs=1e-9
    )


def test_a_turn_with_limits_has_one_way_round(machine: Machine, waypoints: Waypoints) -> None:
    limited = copy(waypoints)
    limited._machine = SimpleNamespace(lower=np.full(len(machine.joints), -2.0))  # type: ignore[assignment]
    carry = machine.posture("carry")
    assert limited.turn_shifts(carry, carry + 1.0) == [0.0]


def test_a_load_is_drawn_in_at_its_height_and_azimuth(
    machine: Machine, waypoints: Waypoints
) -> None:
    kinematics, radius_m = Kinematics(machine), waypoints.carry_radius_m
    out = waypoints._ik.solve(
        pose(t=np.array([1.5, 0.0, 0.5])) @ kinematics.gripper(machine.posture("carry")),
        machine.posture("carry"),
    )
    drawn = waypoints.drawn(out, radius_m)
    before, after = kinematics.gripper(out), kinematics.gripper(drawn)
    assert np.hypot(*after[:2, 3]) == pytest.approx(radius_m, abs=0.01)
    np.testing.assert_allclose(
        [after[2, 3], np.arctan2(after[1, 3], after[0, 3])],
        [before[2, 3], np.arctan2(before[1, 3], before[0, 3])],
        atol=0.01,
    )
    assert angle_between(after[:3, :3], before[:3, :3]) < 0.07


@pytest.mark.parametrize("radius_m", [4.1, 9.0, 1.0])
def test_a_load_that_is_near_already_or_gets_no_nearer_is_not_drawn_in(
    machine: Machine, waypoints: Waypoints, radius_m: float
) -> None:
    assert waypoints.drawn(machine.posture("carry"), radius_m) is None


def test_a_load_is_drawn_in_only_as_far_as_it_takes(machine: Machine, waypoints: Waypoints) -> None:
    gripper, carry = Kinematics(machine).gripper, machine.posture("carry")
    out = waypoints._ik.solve(pose(t=np.array([1.5, 0.0, 0.5])) @ gripper(carry), carry)
    nearest_m = waypoints.carry_radius_m - 0.6

    def radius_m(q: Float) -> float:
        return float(np.hypot(*gripper(q)[:2, 3]))

    found = waypoints.drawn_until(out, nearest_m, lambda q: radius_m(q) < 4.6)
    assert found is not None
    assert 4.45 < radius_m(found) < 4.6
    assert waypoints.drawn_until(out, nearest_m, lambda q: True) is out
    assert waypoints.drawn_until(out, nearest_m, lambda q: radius_m(q) < 3.0) is None
