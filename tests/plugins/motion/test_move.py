"""The parts of a move, with a check and obstacles that say what the test wants."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from executive_plugins.motion.collision import Hit
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.move import Move, NoPath
from executive_plugins.motion.settings import InverseKinematicsSettings
from executive_plugins.motion.timing import Limits
from executive_plugins.motion.waypoints import Line, Waypoints

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.trajectory import JointTrajectory

HIGHEST_M, CLEARANCE_M = 3.0, 0.5
UP = np.array([0.0, 0.0, 1.0])


@dataclass
class Check:
    """Finds the hits that it is given, one a question, the last one for ever."""

    hits: list[Any]
    asked: list[Any] = field(default_factory=list)

    def _next(self, what: Any) -> Any:
        self.asked.append(what)
        return self.hits[min(len(self.asked), len(self.hits)) - 1]

    first_hit = first_hit_along = _next

    def machine_hit(self, q: Float) -> None:
        """The machine never touches itself."""


@dataclass
class Obstacles:
    """Are as high everywhere, and keep what was asked."""

    asked: list[tuple[Any, Any]] = field(default_factory=list)

    def highest(self, azimuths: tuple[float, float], radii: tuple[float, float]) -> float:
        self.asked.append((azimuths, radii))
        return HIGHEST_M


@dataclass
class Lifts:
    """Keeps the heights to which lifts are asked for, and lifts nothing."""

    real: Waypoints
    heights_m: list[float] = field(default_factory=list)

    def lift(self, q: Float, height_m: float) -> None:
        self.heights_m.append(height_m)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.real, name)


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


def move(machine: Machine, *hits: Any) -> Move:
    kinematics = Kinematics(machine)
    ik = InverseKinematics(InverseKinematicsSettings(), machine, kinematics)
    return Move(
        machine=machine,
        waypoints=Lifts(Waypoints(machine, kinematics, ik)),  # type: ignore[arg-type]
        inverse_kinematics=ik,
        check=Check(list(hits)),  # type: ignore[arg-type]
        obstacles=Obstacles(),  # type: ignore[arg-type]
        reaching_gripper=np.zeros((1, 3)),
        limits=Limits(machine.max_velocity, machine.max_acceleration, machine.max_jerk),
        clearance_m=CLEARANCE_M,
        least_arrival=0.5,
    )


def turned(machine: Machine, angle_rad: float) -> Float:
    q = machine.posture("carry").copy()
    q[machine.arm_names.index(machine.turn_joint)] += angle_rad
    return q


def test_a_free_way_is_taken_with_all_joints_at_once(machine: Machine) -> None:
    made, goal = move(machine, None), turned(machine, 0.8)
    found = made.between(machine.posture("carry"), goal)
    assert isinstance(found, JointTrajectory)
    np.testing.assert_allclose(found.position[[0, -1]], [machine.posture("carry"), goal])
    assert made.check.asked == [found]
    assert made.waypoints.heights_m == []


def test_where_that_is_not_free_the_arm_goes_over_the_obstacles(machine: Machine) -> None:
    made, goal = move(machine, (0.2, "jaw with stone"), None), turned(machine, 0.8)
    found = made.between(machine.posture("carry"), goal)
    assert isinstance(found, JointTrajectory)
    np.testing.assert_allclose(found.position[[0, -1]], [machine.posture("carry"), goal], atol=1e-6)
    assert made.waypoints.heights_m == [HIGHEST_M + CLEARANCE_M] * 2


@pytest.mark.parametrize(("angle_rad", "without"), [(0.8, 0), (0.05, 1)])
def test_travels_higher_and_the_other_way_round_and_tells_the_first_collision(
    machine: Machine, angle_rad: float, without: int
) -> None:
    """Tops beside each other are joined without a lift first."""
    made = move(machine, (0.25, "jaw with stone"), (0.5, "arm with ground"))
    lines = (Line(q[None], 0.0) for q in (machine.posture("carry"), turned(machine, angle_rad)))
    found = made.travel(*lines)
    assert isinstance(found, NoPath)
    assert found.reason == "travelling: collision of jaw with stone at fraction 0.25"
    heights = [HIGHEST_M + CLEARANCE_M + more for more in (0.0, 0.6, 1.2) for _ in range(4)]
    assert made.waypoints.heights_m == pytest.approx(heights)
    assert len(made.check.asked) == without + 6
    ends = [one.position[-1] - one.position[0] for one in made.check.asked[without:]]
    turn = machine.arm_names.index(machine.turn_joint)
    both = [angle_rad, angle_rad - 2 * np.pi] * 3
    np.testing.assert_allclose([end[turn] for end in ends], both, atol=1e-6)


@pytest.mark.parametrize(
    ("angle_rad", "sector"),
    [
        (1.0, (-0.2, 1.2)),
        (-1.0, (-1.2, 0.2)),
        (4.0, (-0.2, 4.2)),
        (6.2, (-0.2, 2 * np.pi - 0.2 - 1e-6)),  # never more than the whole circle
    ],
)
def test_what_the_arm_passes_over_is_a_sector_with_margins(
    machine: Machine, angle_rad: float, sector: tuple[float, float]
) -> None:
    made = move(machine, None)
    assert made._highest_between(turned(machine, 0.0), turned(machine, angle_rad)) == HIGHEST_M
    place = Kinematics(machine).gripper(machine.posture("carry"))[:2, 3]
    azimuth, radius = np.arctan2(place[1], place[0]), np.hypot(*place)
    ((asked, radii),) = made.obstacles.asked
    np.testing.assert_allclose(asked, azimuth + np.array(sector), atol=1e-6)
    np.testing.assert_allclose(radii, [radius - 1.5, radius + 1.5], atol=1e-6)


def test_the_ground_s_normal_comes_first_then_the_grasp_s_approach_then_up(
    machine: Machine,
) -> None:
    made, slope = move(machine, None), np.array([0.6, 0.0, 0.8])
    down, aslant, aside = (from_rpy(0.0, angle, 0.0) for angle in (np.pi / 2, 1.2, 0.4))

    def directions(R: Float, normal: Float) -> Iterator[Float]:
        return made._directions(pose(R), normal)

    np.testing.assert_allclose(list(directions(down, UP)), [UP], atol=1e-12)
    np.testing.assert_allclose(list(directions(down, slope)), [slope, UP], atol=1e-12)
    np.testing.assert_allclose(list(directions(aslant, slope)), [slope, -aslant[:, 0], UP])
    np.testing.assert_allclose(list(directions(aside, slope)), [slope, UP])


def test_leaving_fails_by_the_first_collision_on_the_way_up(machine: Machine) -> None:
    free = move(machine, None).leave(machine.posture("carry"), UP, 0.4)
    assert isinstance(free, Line)
    assert free.length_m == pytest.approx(0.4)
    hits = Hit(3, "jaw with stone"), Hit(1, "arm with ground")
    found = move(machine, *hits).leave(machine.posture("carry"), UP, 0.4)
    assert isinstance(found, NoPath)
    share = 3 / len(free.nodes)
    told = f"leaving: collision of jaw with stone at {share:.0%} of the way up"
    assert found.reason == told


def test_an_arrival_is_refused_if_too_little_of_it_is_in_reach_or_it_collides(
    machine: Machine,
) -> None:
    nodes = np.zeros((4, 5))
    free, hit = move(machine, None), move(machine, Hit(2, "jaw with stone"))
    assert free._refusal(Line(nodes, 1.0), 2.0) is None
    short = free._refusal(Line(nodes, 0.99), 2.0)
    assert short is not None
    assert short.reason == "arriving: only 0.99 m of 2.00 m above the goal are in reach"
    refused = hit._refusal(Line(nodes, 0.8), 1.0)
    assert refused is not None
    assert refused.reason == "arriving: collision of jaw with stone, 0.40 m above the goal"


@pytest.mark.parametrize("length_m", [0.3, 0.6])
def test_arrivals_are_sought_from_below_and_from_above_near_the_present_posture_first(
    machine: Machine, length_m: float
) -> None:
    made, carry = move(machine, None), machine.posture("carry")
    gripper, slope = Kinematics(machine).gripper, np.array([0.28, 0.0, 0.96])
    goal = gripper(carry)
    lines = list(made._arrivals(goal, carry, slope, length_m))
    assert len(lines) == 4
    for line in lines:
        assert line.length_m == pytest.approx(length_m)
        np.testing.assert_allclose(gripper(line.nodes[0]), goal, atol=2e-3)
        top = goal[:3, 3] + length_m * slope
        np.testing.assert_allclose(gripper(line.nodes[-1])[:3, 3], top, atol=2e-3)
    np.testing.assert_allclose(lines[0].nodes[0], carry, atol=1e-6)
    # A goal out of reach has no arrival, one whose top is out of reach those from below alone.
    far = pose(t=np.array([9.0, 0.0, 0.0])) @ goal
    assert list(made._arrivals(far, carry, slope, length_m)) == []
    tall = list(made._arrivals(goal, carry, slope, 9.0))
    assert [one.length_m < 8.0 for one in tall] == [True, True]


class Load:
    """Spares what is given for each path, one after the other, and enough at the ends.

    It may pass where the gripper is near enough, by default nowhere.
    """

    def __init__(self, *spares_kg: float, at_ends_kg: float = 100.0, within_m: float = 0.0) -> None:
        self.spares_kg, self.at_ends_kg = list(spares_kg), at_ends_kg
        self.within_m, self.gripper = within_m, Kinematics(load_machine("m545")).gripper
        self.asked: list[Float] = []

    def may_pass(self, q: Float) -> bool:
        return bool(np.hypot(*self.gripper(q)[:2, 3]) <= self.within_m)

    def is_hopeless(self, spare_kg: float) -> bool:
        return spare_kg < -10.0

    def spare_kg(self, positions: Float) -> float:
        if len(positions) == 1:
            return self.at_ends_kg
        self.asked.append(positions)
        return self.spares_kg.pop(0)


def far_out(machine: Machine, made: Move, angle_rad: float) -> Line:
    T = pose(t=np.array([1.5, 0.0, 0.5])) @ Kinematics(machine).gripper(machine.posture("carry"))
    q = made.inverse_kinematics.solve(T, machine.posture("carry"))
    assert q is not None
    q[machine.arm_names.index(machine.turn_joint)] += angle_rad
    return Line(q[None], 0.0)


def radius_m(machine: Machine, positions: Float) -> float:
    at = [Kinematics(machine).gripper(q)[:2, 3] for q in positions[:: len(positions) // 20]]
    return float(np.hypot(*np.array(at).T).min())


def test_a_load_that_is_too_heavy_on_the_direct_path_is_drawn_in(machine: Machine) -> None:
    made = replace(move(machine, None, None), load=Load(-50.0, 20.0))
    found = made.travel(far_out(machine, made, 0.0), far_out(machine, made, 1.5))
    assert isinstance(found, JointTrajectory)
    direct, drawn = made.load.asked
    np.testing.assert_array_equal(found.position, drawn)
    assert radius_m(machine, drawn) < made.waypoints.carry_radius_m + 0.05
    assert radius_m(machine, direct) > made.waypoints.carry_radius_m + 0.5


def test_a_load_is_drawn_in_while_the_cabin_turns_and_only_as_far_as_it_takes(
    machine: Machine,
) -> None:
    ends = [far_out(machine, move(machine), angle_rad) for angle_rad in (0.0, 1.5)]
    carry_m = move(machine).waypoints.carry_radius_m
    turning, before = (
        replace(move(machine, None, None), load=Load(-50.0, 20.0, within_m=within_m))
        for within_m in (carry_m + 0.5, 0.0)
    )
    quick, slow = turning.travel(*ends), before.travel(*ends)
    assert isinstance(quick, JointTrajectory)
    assert isinstance(slow, JointTrajectory)
    assert quick.duration_s < slow.duration_s - 1.0
    assert carry_m + 0.3 < radius_m(machine, quick.position) < carry_m + 0.55
    turn, half = machine.arm_names.index(machine.turn_joint), len(quick.position) // 4
    begun = quick.position[half, turn] - quick.position[0, turn]
    assert begun > 0.1
    assert slow.position[len(slow.position) // 4, turn] == pytest.approx(
        slow.position[0, turn], abs=0.02
    )


def test_the_path_with_the_greatest_capacity_is_taken_if_none_is_enough(machine: Machine) -> None:
    made = replace(move(machine, *[None] * 40), load=Load(-50.0, -10.0, *[-70.0] * 38))
    found = made.travel(far_out(machine, made, 0.0), far_out(machine, made, 1.5))
    assert isinstance(found, JointTrajectory)
    np.testing.assert_array_equal(found.position, made.load.asked[1])


def test_no_other_path_is_sought_for_a_load_that_is_far_too_heavy_at_an_end(
    machine: Machine,
) -> None:
    made = replace(move(machine, None), load=Load(-50.0, at_ends_kg=-11.0))
    assert isinstance(
        made.travel(far_out(machine, made, 0.0), far_out(machine, made, 1.5)), JointTrajectory
    )
    assert len(made.load.asked) == 1


def test_a_load_that_is_a_little_too_heavy_at_an_end_is_drawn_in_on_the_way(
    machine: Machine,
) -> None:
    """It was told heavier than it was weighed; a path that bears as much as its ends is enough."""
    made = replace(move(machine, None, None), load=Load(-50.0, -9.0, at_ends_kg=-9.0))
    found = made.travel(far_out(machine, made, 0.0), far_out(machine, made, 1.5))
    assert isinstance(found, JointTrajectory)
    np.testing.assert_array_equal(found.position, made.load.asked[1])
    assert len(made.load.asked) == 2
