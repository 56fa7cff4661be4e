"""ReleaseStone, ticked to success and to failure."""

from itertools import cycle

import numpy as np
import pytest

from executive.behaviours.plan_placement import PlanPlacement
from executive.behaviours.plan_set_down import PlanSetDown
from executive.behaviours.release_stone import ReleaseStone
from executive.behaviours.verify_placement import VerifyPlacement
from executive.events.stone import StoneLetGo, StoneReleased, StoneWeighed
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.messages.hold import Hold
from executive.messages.segment import Segment
from executive.messages.stone import StoneState
from executive.messages.verdict import Trouble, Verdict
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import SLOTS, placement, plugins, set_down


def test_a_stone_is_released_on_its_slot(world, database):
    ended = world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    assert ended.status == "SUCCESS"
    assert database.stone(1).state is StoneState.PLACED
    (event,) = ended.events
    assert isinstance(event, StoneReleased)
    assert (event.stone, event.slot) == (1, 1)
    np.testing.assert_array_equal(event.estimated_pose, database.stone(1).T_map_object)
    # The gripper has risen by 1.5 m with the stone, which lay at 0.3 m.
    assert event.estimated_pose[2, 3] == pytest.approx(1.8, abs=0.02)
    (asked,) = plugins(world)["robot"].calls("command")
    assert asked["command"].position_rad == pytest.approx(0.8)
    assert world.leaf_context.holds == ["end"]
    assert plugins(world)["mapping"].masks == [0.0]


def test_how_a_stone_was_held_on_its_whole_way_is_kept(world, database):
    world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    stone, T_map_gripper = database.stone(1), world.leaf_context.gripper()
    (T_object_gripper,) = stone.T_object_gripper
    np.testing.assert_allclose(stone.T_map_object @ T_object_gripper, T_map_gripper, atol=1e-9)


@pytest.mark.parametrize("slipped", [False, True])
def test_how_a_stone_was_held_that_slipped_or_was_let_go_is_not_kept(world, database, slipped):
    if slipped:
        world.leaf_context.troubles.append(Verdict(3.0, "hold_state", Trouble.SLIP, "it slid"))
    world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]) if slipped else None)
    assert len(database.stone(1).T_object_gripper) == 0


@pytest.mark.parametrize(
    ("half_m", "neighbour_m", "opening_m"),
    [(0.6, None, 1.3), (0.6, 0.62, 1.2), (0.2, None, None), (0.2, 0.25, 0.66)],
)
def test_jaws_that_have_closed_below_a_stone_open_until_they_rise_past_it(
    stage, world, database, half_m, neighbour_m, opening_m
):
    """Half of the stone's width, and the distance at which another stone begins beside it.

    Where it leaves no room, they open until they just pass the stone, or by 0.06 rad.
    """
    gripper = world.leaf_context.machine().gripper
    bar = np.column_stack([np.full(61, 0.7), np.linspace(-half_m, half_m, 61), np.zeros(61)])
    T_down = pose(from_rpy(0.0, np.pi / 2, 0.0), np.array([5.0, 0.0, 2.0]))
    lying = Segment(0, transform(T_down, bar), transform(T_down, bar).mean(axis=0), np.ones(3))
    (stone,) = database.observe([lying], 1.0, True)
    if neighbour_m is not None:
        y, x = np.meshgrid(
            np.arange(neighbour_m, neighbour_m + 1.2, 0.03), np.arange(0.3, 1.3, 0.03)
        )
        beside = transform(T_down, np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]))
        database.observe([Segment(1, beside, beside.mean(axis=0), np.ones(3))], 1.0, True)
    database.grasp(stone.id, T_down, 2.0)
    world.leaf_context.gripper = lambda: T_down
    world.tick(ReleaseStone, hold=Hold(stone.id, T_down, 0.2), placement=placement(SLOTS[0]))
    (asked,) = plugins(world)["robot"].calls("command")
    least_m = gripper.opening_m(0.4)
    expected_m = least_m if opening_m is None else opening_m
    assert gripper.opening_m(asked["command"].position_rad) == pytest.approx(expected_m, abs=0.05)


@pytest.mark.parametrize(("up_n", "stops"), [(5e3, False), (39e3, True)])
def test_jaws_that_would_lift_the_machine_stop(world, database, up_n, stops):
    """The scan posture reaches 4 m out; half a ton there is no more than a stone weighs."""
    world.leaf_context.pushed = lambda time_s: np.array([0.0, 0.0, up_n if time_s > 0.2 else 0.0])
    ended = world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    assert (ended.status, "lifted the machine" in ended.reason) == ("SUCCESS", stops)
    commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
    jaw_rad = world.leaf_context.jaw(0.0)
    assert [one.position_rad for one in commands[1:]] == ([jaw_rad] if stops else [])
    assert database.stone(1).state is StoneState.PLACED


def test_a_single_jerk_of_the_jaws_stops_nothing(world):
    told = cycle([0.0, -10e3, -5e3, 0.0, 39e3, -5e3])
    world.leaf_context.pushed = lambda time_s: np.array([0.0, 0.0, next(told)])
    ended = world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    assert (ended.status, ended.reason) == ("SUCCESS", "")


def test_a_stone_that_is_let_go_lies_on_the_ground_below(world, database):
    ended = world.tick(ReleaseStone, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert database.stone(1).state is StoneState.ON_GROUND
    (event,) = ended.events
    assert isinstance(event, StoneLetGo)
    assert event.estimated_pose[2, 3] == pytest.approx(0.3, abs=0.05)


@pytest.mark.parametrize("leaf", [ReleaseStone, PlanSetDown, PlanPlacement])
def test_nothing_is_planned_or_released_while_the_arm_moves(world, leaf):
    arm = world.leaf_context.arm()
    world.leaf_context.positions = lambda t: arm + 0.2 * t
    world.leaf_context.velocities = lambda t: np.full(len(arm), 0.2)
    given = {"free_slots": SLOTS} if leaf is PlanPlacement else {}
    ended = world.tick(leaf, hold=world.hold, **given)
    assert ended.status == "FAILURE"
    assert "still moves" in ended.reason
    assert plugins(world)["robot"].asked == plugins(world)["motion"].asked == []


def test_a_stone_that_hangs_in_the_opened_jaws_is_not_placed(world, database):
    planned = set_down(world, database, realigned=pose())
    world.leaf_context.weighed, world.leaf_context.payload = Weight(1500.0, 30.0), 1450.0
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, "hangs in the jaws with 1450 kg" in ended.reason) == ("FAILURE", True)
    world.leaf_context.payload = 40.0
    assert world.tick(VerifyPlacement, stone=1, placement=planned).status == "SUCCESS"


def test_jaws_that_vibrate_hold_nothing(world, database):
    """A sample in two tells more than half of the stone, and the mean nothing."""
    planned = set_down(world, database, realigned=pose())
    context, told = world.leaf_context, cycle([900.0, -900.0])
    context.weighed = Weight(1500.0, 30.0)
    context.payload_kg = lambda: next(told)
    assert world.tick(VerifyPlacement, stone=1, placement=planned).status == "SUCCESS"
    assert context.time_s >= 1.0  # it was weighed for a second


@pytest.mark.parametrize("share", [0.4, 2.0])
@pytest.mark.parametrize("carried", [False, True])
def test_a_stone_that_is_let_go_before_it_hung_free_keeps_no_weight(
    world, database, share: float, carried: bool
):
    """The ground carried a part of it, or held it back."""
    weight = Weight(share * database.stone(1).mass_kg, 20.0)
    world.leaf_context.weighed, world.leaf_context.carried = weight, carried
    assert world.tick(ReleaseStone, hold=world.hold).status == "SUCCESS"
    assert database.stone(1).weight == (weight if carried else None)
    told = any(isinstance(one, StoneWeighed) for one in world.leaf_context.events)
    assert told is carried


def test_what_was_weighed_of_a_stone_that_has_slipped_is_not_kept(world, database):
    context = world.leaf_context
    context.weighed, context.carried = Weight(1500.0, 30.0), True
    context.troubles.append(Verdict(1.0, "hold_state", Trouble.SLIP, "it slid"))
    assert (
        world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0])).status == "SUCCESS"
    )
    assert database.stone(1).weight is None
    assert not any(isinstance(one, StoneWeighed) for one in context.events)


@pytest.mark.parametrize("carried", [False, True])
def test_a_stone_that_fell_at_once_keeps_what_it_weighed_as_it_hung(world, database, carried):
    context, weight = world.leaf_context, Weight(1500.0, 30.0)
    context.weighed, context.carried = weight, carried
    context.troubles.append(Verdict(1.0, "hold_state", Trouble.DROP, "it fell"))
    assert world.tick(ReleaseStone, hold=world.hold).status == "SUCCESS"
    assert database.stone(1).state is StoneState.LOST
    assert database.stone(1).weight == (weight if carried else None)


def test_what_was_weighed_is_kept_with_the_stone(world, database):
    world.leaf_context.weighed = Weight(1500.0, 30.0)
    ended = world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    assert [type(event).__name__ for event in ended.events] == ["StoneReleased", "StoneWeighed"]
    stone = database.stone(1)
    assert (stone.weight, stone.mass_kg) == (Weight(1500.0, 30.0), 1500.0)
    assert stone.mass_source == "weighed, ± 30 kg"
    assert database.stone(2).weight is None
