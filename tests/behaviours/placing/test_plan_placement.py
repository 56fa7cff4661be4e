"""PlanPlacement, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.plan_placement import PlanPlacement
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.surroundings import held_surface
from executive.leaf.turned import lower_by_m
from executive.machine.lean import Lean
from executive.messages.placement import Slot
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import NO_PATH, NO_WAY, SLOTS, placement, plugins


def test_the_first_placement_with_a_path_is_taken(stage, world, database):
    first, second, third = placement(SLOTS[0]), placement(SLOTS[0]), placement(SLOTS[1])
    planner = stage.Scripted(PlacementPlanner, plan=[(first, second), (third,)])
    motion = stage.Scripted(MotionPlanner, move=[NO_WAY, NO_WAY, world.found])
    plugins(world).update(placing=planner, motion=motion)
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS)
    assert (ended.status, ended.reason) == ("SUCCESS", "slot 2")
    assert ended.outputs == {"placement": third, "trajectory": world.path}
    assert [asked["slot"].id for asked in planner.calls("plan")] == [1, 2]
    assert {asked["stone"].id for asked in planner.calls("plan")} == {1}
    requests = [asked["request"] for asked in motion.calls("move")]
    np.testing.assert_array_equal(requests[-1].T_map_gripper, third.T_map_gripper)
    own = len(database.stone(1).points_map)
    assert [len(request.held_gripper) for request in requests] == [own] * 3
    assert {request.jaw_rad for request in requests} == {0.6}


def tilted_in_jaws(database, tilt_rad):
    """Tilt the held stone 1 about its centroid, and turn it about the vertical."""
    centre = pose(t=database.stone(1).centroid_map)
    T = centre @ pose(from_rpy(tilt_rad, 0.0, 0.7)) @ inverse(centre)
    return database.realign(1, T, 3.0, "in the jaws")


def test_a_stone_that_was_tilted_in_the_jaws_is_turned_back_to_the_side_on_which_it_lay(
    stage, world, database
):
    held = tilted_in_jaws(database, 0.48)
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),)])
    plugins(world).update(placing=planner, motion=stage.Scripted(MotionPlanner, move=[world.found]))
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS[:1])
    assert (ended.status, ended.reason) == ("SUCCESS", "slot 1, turned back by 27.5°")
    (asked,) = planner.calls("plan")
    np.testing.assert_allclose(asked["stone"].T_map_object[2, :3], [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(asked["stone"].centroid_map, held.centroid_map, atol=1e-9)
    # The gripper moves with the stone.
    in_jaws = [inverse(T) @ one.T_map_object for T, one in (
        (asked["T_map_gripper"], asked["stone"]), (world.hold.T_map_gripper, held)
    )]  # fmt: skip
    np.testing.assert_allclose(*in_jaws, atol=1e-9)


def test_a_tilted_stone_for_which_no_way_leads_to_its_rest_is_set_down_as_it_hangs(
    stage, world, database
):
    tilted_in_jaws(database, 0.48)
    last = placement(SLOTS[0])
    planner = stage.Scripted(PlacementPlanner, plan=[(), (last,)])
    plugins(world).update(placing=planner, motion=stage.Scripted(MotionPlanner, move=[world.found]))
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS[:1])
    assert (ended.status, ended.reason) == ("SUCCESS", "slot 1")
    assert ended.outputs["placement"] is last
    hanging = planner.calls("plan")[1]["stone"]
    np.testing.assert_array_equal(hanging.T_map_object, database.stone(1).T_map_object)


def test_a_slot_with_a_pose_says_itself_how_the_stone_rests(stage, world, database):
    tilted_in_jaws(database, 0.48)
    slot = Slot(1, np.array([4.0, -3.0, 0.0]), T_map_object=pose(t=np.array([4.0, -3.0, 0.4])))
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(slot),)])
    plugins(world).update(placing=planner, motion=stage.Scripted(MotionPlanner, move=[world.found]))
    assert world.tick(PlanPlacement, hold=world.hold, free_slots=[slot]).reason == "slot 1"
    assert len(planner.calls("plan")) == 1


POSED = Slot(1, np.array([4.0, -3.0, 0.0]), T_map_object=pose(t=np.array([4.0, -3.0, 0.4])))


def test_a_tilted_stone_without_a_way_to_the_pose_of_its_slot_hangs_over_it(stage, world, database):
    held = tilted_in_jaws(database, 0.3)
    planner = stage.Scripted(PlacementPlanner, plan=[(), (placement(POSED),)])
    plugins(world).update(placing=planner, motion=stage.Scripted(MotionPlanner, move=[world.found]))
    given = {"as_it_hangs": True}
    ended = world.tick(PlanPlacement, settings=given, hold=world.hold, free_slots=[POSED])
    assert (ended.status, ended.reason) == ("SUCCESS", "slot 1, as it hangs")
    hung = planner.calls("plan")[1]["slot"].T_map_object
    # It is turned about the vertical alone, and is judged by the rest that was planned.
    np.testing.assert_allclose(hung[2, :3], held.T_map_object[2, :3], atol=1e-9)
    assert ended.outputs["placement"].slot is POSED
    np.testing.assert_array_equal(ended.outputs["placement"].T_map_object, POSED.T_map_object)


@pytest.mark.parametrize(("tilt_rad", "given"), [(0.3, {}), (1.2, {"as_it_hangs": True})])
def test_it_hangs_over_it_only_where_that_is_asked_for_and_it_would_tilt_back(
    stage, world, database, tilt_rad: float, given: dict[str, bool]
):
    tilted_in_jaws(database, tilt_rad)
    planner = stage.Scripted(PlacementPlanner, plan=[()])
    plugins(world)["placing"] = planner
    ended = world.tick(PlanPlacement, settings=given, hold=world.hold, free_slots=[POSED])
    assert ended.status == "FAILURE"
    assert len(planner.calls("plan")) == 1


@pytest.mark.parametrize("hangs", [False, True])
@pytest.mark.parametrize(("mass_kg", "status"), [(900.0, "SUCCESS"), (2900.0, "FAILURE")])
def test_a_way_beyond_the_lift_capacity_is_no_way(stage, world, database, mass_kg, status, hangs):
    """The arm swings out to 6 m at the side, where the machine carries 1 t.

    What hangs in the jaws counts, and what was known of the stone before if that is not weighed.
    """
    machine = world.leaf_context.machine()
    far = dict(zip(machine.arm_names, machine.posture("carry"), strict=True))
    far |= {"J_TURN": 1.57, "J_BOOM": 0.75, "J_DIPPER": 0.3, "J_TELE": 1.2, "J_EE_PITCH": -1.19}
    position = np.stack([machine.posture("carry"), [*far.values()]])
    way = JointTrajectory(machine.arm_names, np.array([0.0, 9.0]), position, 0 * position)
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),)])
    motion = stage.Scripted(MotionPlanner, move=[MotionPlan(way, "", NO_PATH)])
    plugins(world).update(placing=planner, motion=motion)
    database.weigh(1, Weight(5000.0 - mass_kg if hangs else mass_kg, 20.0), 3.0)
    if hangs:
        world.leaf_context.weight = lambda: Weight(mass_kg, 20.0)
    given = {"lift_capacity": "iso_10567"}
    ended = world.tick(PlanPlacement, settings=given, hold=world.hold, free_slots=SLOTS[:1])
    assert ended.status == status
    assert ("beyond the lift capacity" in ended.reason) == (status == "FAILURE")


@pytest.mark.parametrize("reached", [True, False])
@pytest.mark.parametrize("mass_kg", [0.0, 2000.0])
def test_the_way_leads_to_where_the_place_is_once_the_machine_leans(stage, world, mass_kg, reached):
    m545 = world.leaf_context.machine()
    stance = m545.stance.model_copy(update={"support_n_m": 2e6})
    world.leaf_context.machine = lambda: m545.model_copy(update={"stance": stance})
    world.leaf_context.weight = lambda: Weight(mass_kg, 30.0)
    side = world.leaf_context.arm().copy()
    side[m545.arm_names.index(m545.turn_joint)] += np.pi / 2
    motion = stage.Scripted(MotionPlanner, move=[world.found], reach=[side if reached else None])
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),)])
    plugins(world).update(placing=planner, motion=motion)
    given = {"lift_capacity": "payload"}
    ended = world.tick(PlanPlacement, settings=given, hold=world.hold, free_slots=SLOTS[:1])
    assert ended.status == "SUCCESS"
    (asked,) = motion.calls("move")
    now = world.leaf_context.state().T_map_base
    leans = Lean(world.leaf_context.machine()).moved(now, world.leaf_context.arm(), side, mass_kg)
    np.testing.assert_array_equal(asked["request"].T_map_base, leans if reached else now)
    assert np.abs(leans - now).max() > 1e-3


@pytest.mark.parametrize("known", [True, None, False])
def test_a_stone_that_was_not_seen_as_it_hangs_is_carried_as_high_as_it_may_hang_lower(
    stage, world, known
):
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),)])
    motion = stage.Scripted(MotionPlanner, move=[world.found])
    plugins(world).update(placing=planner, motion=motion)
    ports = {"hold": world.hold, "free_slots": SLOTS[:1]}
    if known is not None:
        ports["hang_is_known"] = known
    ended = world.tick(PlanPlacement, settings={"above": 0.03}, **ports)
    assert ended.status == "SUCCESS"
    (asked,) = motion.calls("move")
    above_m = asked["request"].T_map_gripper[2, 3] - placement(SLOTS[0]).T_map_gripper[2, 3]
    surface = held_surface(world.leaf_context, world.hold)
    lower_m = lower_by_m(
        world.leaf_context.machine(), world.hold.jaw_rad, surface, asked["request"].T_map_gripper
    )
    assert lower_m > 0.1
    assert above_m == pytest.approx(0.03 + (lower_m if known is False else 0.0))


def test_no_slot_with_a_path_is_a_failure_with_each_cause(stage, world):
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),), ()])
    plugins(world)["placing"] = planner
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS)
    assert ended.status == "FAILURE"
    assert "slot 1: the boom would hit stone 2" in ended.reason
    assert "slot 2: no placement is free and in reach" in ended.reason
    assert ended.outputs == {}


def test_a_cause_of_several_slots_is_told_once(stage, world):
    plugins(world)["placing"] = stage.Scripted(PlacementPlanner, plan=[(), ()])
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS)
    assert "2 slots: slots 1, 2: no placement is free and in reach" in ended.reason
    assert ended.reason.count("free and in reach") == 1


def test_the_slot_that_is_meant_for_the_stone_comes_first_and_those_of_others_last(stage, world):
    """The stone was taken from where the gripper closed."""
    x, y, _ = world.hold.T_map_gripper[:3, 3]
    places = [np.array([4.0 + i, -3.0, 0.0]) for i in range(3)]
    other = Slot(1, places[0], meant_for_map=np.array([x, y + 3.0, 0.4]))
    own = Slot(3, places[2], meant_for_map=np.array([x + 0.3, y, 0.4]))
    planner = stage.Scripted(PlacementPlanner, plan=[(), (), ()])
    plugins(world)["placing"] = planner
    world.tick(PlanPlacement, hold=world.hold, free_slots=[other, Slot(2, places[1]), own])
    assert [call["slot"].id for call in planner.calls("plan")] == [3, 2, 1]
