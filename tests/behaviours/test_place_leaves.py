"""Leaves that set a stone down and look whether it is there, ticked to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from executive.behaviours.check_placed import CheckPlaced
from executive.behaviours.detect_slip import DetectSlip
from executive.behaviours.find_again import FindAgain
from executive.behaviours.find_lost import FindLost
from executive.behaviours.forget_place import ForgetPlace
from executive.behaviours.has_arrived import HasArrived
from executive.behaviours.is_hanging import IsHanging
from executive.behaviours.is_holding import IsHolding
from executive.behaviours.lower_until_down import LowerUntilDown
from executive.behaviours.plan_grasp import PlanGrasp
from executive.behaviours.plan_placement import PlanPlacement
from executive.behaviours.plan_set_down import PlanSetDown
from executive.behaviours.release_stone import ReleaseStone
from executive.behaviours.relocate_and_realign import RelocateAndRealign
from executive.behaviours.see_held import SeeHeld
from executive.behaviours.set_aside import SetAside
from executive.behaviours.verify_placement import VerifyPlacement
from executive.errors import DataError
from executive.events.stone import (
    ArrivedEarly,
    PlaceForgotten,
    PlacementVerified,
    StoneLetGo,
    StoneLost,
    StoneRealigned,
    StoneReleased,
    StoneSeenInJaws,
    StoneSoughtAgain,
    StoneTouchedDown,
)
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.alignment import Aligner
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.interfaces.registration import Registrar
from executive.interfaces.robot import Robot
from executive.interfaces.segmentation import Segmenter
from executive.leaf.surroundings import held_surface
from executive.machine.kinematics import Kinematics
from executive.messages.alignment import Alignment, Uncertainty
from executive.messages.cloud import Cloud
from executive.messages.command import SwitchLidars
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory
from executive.messages.verdict import Trouble, Verdict
from executive.messages.weight import Weight

NO_PATH = np.zeros((0, 3))
NO_WAY = MotionPlan(None, "the boom would hit stone 2", NO_PATH)
SLIP = Verdict(3.0, "jaw_slip", Trouble.SLIP, "jaws 0.5 m open, 0.6 m before")
DROP = Verdict(4.0, "payload_drop", Trouble.DROP, "12 kg left of 900 kg")
EMPTY = Verdict(4.0, "jaw_slip", Trouble.EMPTY, "jaws 0.02 m open")
SLIPPED = ", after a slip: jaws 0.5 m open, 0.6 m before"
SLOTS = [Slot(1, np.array([4.0, -3.0, 0.0])), Slot(2, np.array([5.0, -4.0, 0.0]))]


@pytest.fixture
def world(stage, database):
    """Return a stage on which stone 1 is held 1.5 m above flat ground, below the gripper."""
    grid = np.stack(np.meshgrid(np.arange(0, 9, 0.1), np.arange(-5, 5, 0.1)), -1).reshape(-1, 2)
    stand = stage.Stage(
        robot=stage.Scripted(Robot),
        mapping=stage.PointMap(np.column_stack([grid, np.zeros(len(grid))])),
        objects=database,
        motion=stage.Scripted(MotionPlanner, move=NO_WAY),
    )
    context = stand.leaf_context
    T_at_grasp = pose(t=np.array([5.0, 0.0, 0.5]))
    database.grasp(1, T_at_grasp, 2.0)
    stand.hold = Hold(1, T_at_grasp, 0.6)
    start = context.arm()
    position = np.stack([start, start + 0.1])
    stand.path = JointTrajectory(
        context.machine().arm_names, np.array([0.0, 1.0]), position, np.zeros_like(position)
    )
    stand.found = MotionPlan(stand.path, "", NO_PATH)
    return stand


def plugins(stand):
    return stand.leaf_context.plugins


def placement(slot, T_map_gripper=None):
    T = pose(t=slot.position_map + [0.0, 0.0, 0.5]) if T_map_gripper is None else T_map_gripper
    return Placement(slot, T, pose(t=slot.position_map))


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


@pytest.mark.parametrize(("mass_kg", "status"), [(900.0, "SUCCESS"), (2900.0, "FAILURE")])
def test_a_way_beyond_the_lift_capacity_is_no_way(stage, world, database, mass_kg, status):
    """The arm swings out to 6 m at the side, where the machine carries 1 t."""
    machine = world.leaf_context.machine()
    far = dict(zip(machine.arm_names, machine.posture("carry"), strict=True))
    far |= {"J_TURN": 1.57, "J_BOOM": 0.75, "J_DIPPER": 0.3, "J_TELE": 1.2, "J_EE_PITCH": -1.19}
    position = np.stack([machine.posture("carry"), [*far.values()]])
    way = JointTrajectory(machine.arm_names, np.array([0.0, 9.0]), position, 0 * position)
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),)])
    motion = stage.Scripted(MotionPlanner, move=[MotionPlan(way, "", NO_PATH)])
    plugins(world).update(placing=planner, motion=motion)
    database.weigh(1, Weight(mass_kg, 20.0), 3.0)
    given = {"lift_capacity": "iso_10567"}
    ended = world.tick(PlanPlacement, settings=given, hold=world.hold, free_slots=SLOTS[:1])
    assert ended.status == status
    assert ("beyond the lift capacity" in ended.reason) == (status == "FAILURE")


def test_no_slot_with_a_path_is_a_failure_with_each_cause(stage, world):
    planner = stage.Scripted(PlacementPlanner, plan=[(placement(SLOTS[0]),), ()])
    plugins(world)["placing"] = planner
    ended = world.tick(PlanPlacement, hold=world.hold, free_slots=SLOTS)
    assert ended.status == "FAILURE"
    assert "slot 1: the boom would hit stone 2" in ended.reason
    assert "no placement on slot 2 is in reach" in ended.reason
    assert ended.outputs == {}


def test_no_slip_is_success_and_the_first_verdict_is_told(world):
    assert world.tick(DetectSlip).status == "SUCCESS"
    world.leaf_context.troubles = [SLIP, DROP]
    ended = world.tick(DetectSlip)
    assert ended.status == "FAILURE"
    assert ended.reason == "slip reported by jaw_slip: jaws 0.5 m open, 0.6 m before"


@pytest.mark.parametrize(
    ("troubles", "jaw_rad", "status"),
    [
        ([], 0.6, "SUCCESS"),
        ([SLIP], 0.6, "SUCCESS"),
        ([SLIP, DROP], 0.6, "FAILURE"),
        ([DROP], 0.6, "FAILURE"),
        ([EMPTY], 0.6, "FAILURE"),
        ([], 0.01, "FAILURE"),
        ([SLIP], 0.01, "FAILURE"),
    ],
)
def test_a_stone_is_held_while_the_jaws_are_apart_and_none_has_fallen(
    world, troubles, jaw_rad, status
):
    world.leaf_context.troubles, world.leaf_context.jaw = troubles, lambda t: jaw_rad
    ended = world.tick(IsHolding)
    assert ended.status == status
    fallen = "the stone was dropped" if jaw_rad > 0.5 else "the jaws are closed to 0.01 rad"
    assert ended.reason == ("" if status == "SUCCESS" else fallen)


@pytest.mark.parametrize(
    ("standing", "status", "reason"),
    [
        (0.5, "SUCCESS", ""),
        (None, "SUCCESS", "no monitor tells whether the ground carries the stone"),
        (0.98, "FAILURE", "the ground carries the stone (p = 0.98)"),
    ],
)
def test_a_stone_hangs_until_a_monitor_tells_that_it_stands(world, standing, status, reason):
    world.leaf_context.on_ground = standing
    ended = world.tick(IsHanging)
    assert (ended.status, ended.reason) == (status, reason)


def test_a_stone_that_met_the_ground_early_has_arrived(world):
    T = world.leaf_context.gripper()
    T[:3, 3] -= [0.05, 0.0, 0.2]
    world.leaf_context.troubles = [SLIP]
    ended = world.tick(HasArrived, placement=placement(SLOTS[0], T))
    assert ended.status == "SUCCESS"
    (event,) = ended.events
    assert isinstance(event, ArrivedEarly)
    assert (event.aside_m, event.above_m) == (pytest.approx(0.05), pytest.approx(0.2))


@pytest.mark.parametrize(
    ("offset_m", "troubles", "reason"),
    [
        ((0.0, 0.2, 0.0), [SLIP], f"0.00 m above and 0.20 m beside the placement{SLIPPED}"),
        ((0.0, 0.0, 0.4), [SLIP], f"0.40 m above and 0.00 m beside the placement{SLIPPED}"),
        ((0.0, 0.0, 0.0), [SLIP, DROP], "the stone was dropped: 12 kg left of 900 kg"),
    ],
)
def test_a_stone_that_is_elsewhere_or_fell_has_not_arrived(world, offset_m, troubles, reason):
    T = world.leaf_context.gripper()
    T[:3, 3] -= offset_m
    world.leaf_context.troubles = troubles
    ended = world.tick(HasArrived, placement=placement(SLOTS[0], T))
    assert (ended.status, ended.reason, ended.events) == ("FAILURE", reason, [])


def test_a_slipping_stone_is_set_down_on_the_ground_below(stage, world):
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.outputs == {"trajectory": world.path}
    (asked,) = motion.calls("move")
    # The gripper is at 2 m and has risen by 1.5 m since the grasp on the ground.
    z = asked["request"].T_map_gripper[2, 3]
    assert z == pytest.approx(0.5, abs=0.1)
    assert asked["request"].arrive_m == pytest.approx(2.0 - z)


def above_the_other_stone(world):
    """Let the gripper hold stone 1 above stone 2."""
    over = world.leaf_context.gripper()
    over[:2, 3] = 5.0, 3.0
    world.leaf_context.gripper = lambda: over.copy()
    return over


def test_a_slipping_stone_is_set_down_beside_a_stone_that_is_below(stage, world, database):
    over = above_the_other_stone(world)
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "aside of another stone" in ended.reason
    (asked,) = motion.calls("move")
    goal = asked["request"].T_map_gripper
    held = asked["request"].held_gripper[:, :2] + goal[:2, 3]
    other = database.stone(2).points_map[:, :2]
    apart = np.linalg.norm(held[:, None] - other, axis=-1).min()
    assert 0.3 <= apart < 0.6  # no nearer than is safe, and no farther than is needed
    assert goal[2, 3] == pytest.approx(0.5, abs=0.1)  # on the ground, not on the stone
    assert over[2, 3] == 2.0


def test_a_slipping_stone_is_set_down_on_another_one_where_nothing_else_is_in_reach(stage, world):
    above_the_other_stone(world)
    motion = stage.Scripted(MotionPlanner, move=[NO_WAY] * 4 + [world.found])
    plugins(world)["motion"] = motion
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "aside" not in ended.reason
    asked = motion.calls("move")
    assert len(asked) == 5
    np.testing.assert_allclose(asked[-1]["request"].T_map_gripper[:2, 3], [5.0, 3.0])


def test_a_stone_is_not_set_down_without_a_path_or_a_gap(world):
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert (ended.status, ended.reason) == (
        "FAILURE",
        "no path down: the boom would hit stone 2",
    )
    low = world.leaf_context.gripper()
    low[2, 3] = 0.5
    world.leaf_context.gripper = lambda: low.copy()
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert (ended.status, ended.reason) == ("FAILURE", "the stone is at the ground already")


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


@pytest.mark.parametrize(
    ("half_m", "neighbour_m", "opening_m"),
    [(0.6, None, 1.3), (0.6, 0.62, None), (0.2, None, None)],
)
def test_jaws_that_have_closed_below_a_stone_open_until_they_rise_past_it(
    stage, world, database, half_m, neighbour_m, opening_m
):
    """Half of the stone's width, and the distance at which another stone begins beside it."""
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


def seen_in_jaws(stage, world, T_model_view, accepted=True):
    """Let the arm stay where it is on each path, and the aligner answer a motion of the view."""
    names = world.leaf_context.machine().arm_names
    stay = np.stack([world.leaf_context.arm()] * 2)
    path = JointTrajectory(names, np.array([0.0, 1.0]), stay, np.zeros_like(stay))
    doubt = Uncertainty(np.diag([0.01**2] * 3 + [0.005**2] * 3), np.array([0.0, 0.0, -0.2]))
    answer = Alignment(
        T_model_view,
        accepted,
        "rmse 5 cm above 4",
        0.01,
        0.9,
        uncertainty=doubt if accepted else None,
    )
    plugins(world).update(
        motion=stage.Scripted(MotionPlanner, move=MotionPlan(path, "", NO_PATH)),
        alignment=stage.Scripted(Aligner, align=answer),
    )


def rises(world):
    """Let the gripper rise by 1.2 m within a second; return its heights at commands of lidars."""
    context, robot, switched_m = world.leaf_context, plugins(world)["robot"], []

    def command(command):
        if isinstance(command, SwitchLidars):
            switched_m.append(context.gripper()[2, 3])

    context.gripper = lambda: pose(t=np.array([5.0, 0.0, 2.0 + 1.2 * min(context.time_s, 1.0)]))
    robot.answers(command=command)
    return switched_m


def test_a_stone_that_the_closing_jaws_moved_is_corrected_in_the_database(stage, world, database):
    before = database.stone(1).centroid_map
    seen_in_jaws(stage, world, pose(t=np.array([-0.05, 0.0, 0.0])))  # the view moves to the model
    seen = held_surface(world.leaf_context, world.hold)[:200] + [0.05, 0.0, 0.0]
    plugins(world)["mapping"].seen = seen
    switched_m = rises(world)
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS", ended.reason
    (asked,) = plugins(world)["motion"].calls("move")  # one motion, without a stop on the way
    assert asked["request"].T_map_gripper[2, 3] == pytest.approx(2.0 + 0.7 + 0.5)
    assert switched_m[0] == pytest.approx(2.0 + 0.7, abs=0.06)  # once it is clear of the ground
    moved = database.stone(1).centroid_map - before
    np.testing.assert_allclose(moved, [0.05, 0.0, 0.0], atol=0.003)  # the expectation counts too
    assert database.stone(1).state is StoneState.HELD
    (event,) = ended.events
    assert isinstance(event, StoneSeenInJaws)
    assert (event.accepted, event.points) == (True, 200)
    assert event.shift_m == pytest.approx(0.05, abs=0.003)
    assert 0.003 < event.position_std_m < 0.006
    lidars = [one["command"] for one in plugins(world)["robot"].calls("command")]
    assert [one.on for one in lidars if isinstance(one, SwitchLidars)] == [True, False]


def test_a_view_of_another_form_is_not_the_stone(stage, world, database):
    before = database.stone(1).T_map_object
    seen_in_jaws(stage, world, pose(t=np.array([-0.05, 0.0, 0.0])))
    model = held_surface(world.leaf_context, world.hold)
    middle = model.mean(axis=0)
    plugins(world)["mapping"].seen = middle + (model - middle) * [0.8, 0.8, 1.0] + [0.05, 0, 0]
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "FAILURE"
    told = "stone 1 does not lie in the jaws as expected, and how it lies is not known: "
    assert ended.reason.startswith(told)
    assert "of what is seen in the jaws has the form of the stone" in ended.reason
    np.testing.assert_array_equal(database.stone(1).T_map_object, before)
    assert [(one.accepted, one.shift_m) for one in ended.events] == [(False, None)]


def test_a_view_that_is_refused_keeps_the_expected_pose(stage, world, database):
    before = database.stone(1).T_map_object
    seen_in_jaws(stage, world, pose(t=np.array([-0.2, 0.0, 0.0])), accepted=False)
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.reason == "kept the expected pose of stone 1: rmse 5 cm above 4"
    np.testing.assert_array_equal(database.stone(1).T_map_object, before)
    assert [(one.accepted, one.shift_m) for one in ended.events] == [(False, None)]


def test_a_stone_that_cannot_be_raised_is_not_looked_at(world, database):
    plugins(world)["alignment"] = None
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "no path up: the boom would hit stone 2" in ended.reason
    assert ended.events == []


BOOM = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


class Arm:
    """An arm that is where its path is, and stands still where it is stopped."""

    def __init__(self, context, start):
        self._context, self._path, self._began_s = context, None, 0.0
        self._still, self.stopped_s = start, []

    def at(self):
        if self._path is None:
            return self._still
        return self._path.at(self._context.time_s - self._began_s)[0]

    def command(self, command):
        self._path, self._began_s = command.trajectory, self._context.time_s

    def stop(self):
        self._still, self._path = self.at(), None
        self.stopped_s.append(self._context.time_s)


@pytest.fixture
def lowering(stage, world):
    """Let the arm follow paths that lower the gripper; 900 kg hang in the jaws above the ground."""

    def lower(ground_m, weighed=True, jolted=lambda payload_kg: payload_kg, free_m=1.0):
        context = world.leaf_context
        kinematics = Kinematics(context.machine())
        arm = Arm(context, context.machine().posture("carry"))
        offset_m = 2.0 - kinematics.gripper(arm.at())[2, 3]

        def height_m():
            return kinematics.gripper(arm.at())[2, 3] + offset_m

        def move(request):
            """Plan by the boom alone, whose turn by some mrad moves the gripper down."""
            if request.arrive_m > free_m:
                return NO_WAY
            goal = minimize_scalar(
                lambda turn: abs(
                    kinematics.gripper(request.start - turn * BOOM)[2, 3]
                    + offset_m
                    - request.T_map_gripper[2, 3]
                ),
                bounds=(0.0, 0.2),
                method="bounded",
            )
            position = request.start - np.linspace(0.0, goal.x, 20)[:, None] * BOOM
            path = JointTrajectory(
                context.machine().arm_names,
                np.linspace(0.0, 0.5, 20),
                position,
                np.zeros_like(position),
            )
            return MotionPlan(path, "", NO_PATH)

        context.positions = lambda time_s: arm.at()
        context.gripper = lambda: pose(t=np.array([5.0, 0.0, height_m()]))
        context.payload_kg = jolted(lambda: 900.0 if height_m() > ground_m else 40.0)
        context.weighed = Weight(900.0, 20.0) if weighed else None
        world.arm = arm
        plugins(world)["robot"].answers(command=arm.command, stop=arm.stop)
        plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=move)
        planned = placement(SLOTS[0], pose(t=np.array([5.0, 0.0, 1.94])))
        return world.tick(LowerUntilDown, hold=world.hold, placement=planned)

    return lower


@pytest.mark.parametrize("ground_m", [1.97, 1.945, 1.83])
def test_a_stone_is_lowered_until_the_ground_carries_it(lowering, world, ground_m):
    """The ground is higher than planned, as planned, and lower.

    A mean over a window of 0.4 s falls to a half within 0.2 s of the touch, while the gripper sinks
    by 1 cm.
    """
    ended = lowering(ground_m)
    assert ended.status == "SUCCESS"
    (event,) = ended.events
    assert isinstance(event, StoneTouchedDown)
    assert event.left_kg == 40.0
    assert ground_m - 1.94 - 0.02 < event.above_m <= ground_m - 1.94
    assert len(world.arm.stopped_s) == 1  # it is stopped on the way, once
    # It sinks by a step of 2 cm in each window of 0.4 s; ramps, weighings and rest take 2 s.
    assert world.arm.stopped_s[0] == pytest.approx((2.0 - ground_m) / 0.05 + 0.8, abs=0.3)


def test_of_a_way_that_is_not_free_what_is_free_is_gone(lowering, world):
    """No more than 0.1 m at a time are free; of 0.26 m that are a quarter, and so on."""
    ended = lowering(1.83, free_m=0.1)
    assert ended.status == "SUCCESS"
    assert 1.83 - 1.94 - 0.02 < ended.events[0].above_m <= 1.83 - 1.94
    asked = [one["request"].arrive_m for one in plugins(world)["motion"].calls("move")]
    assert asked[:3] == pytest.approx([0.26, 0.13, 0.065])
    assert len(world.arm.stopped_s) == 1


def test_a_stone_that_is_lifted_again_by_a_jolt_is_lowered_on(lowering, world):
    """For 0.3 s nothing is weighed, as if the ground carried it; then it hangs as before."""
    context = world.leaf_context

    def jolted(payload_kg):
        return lambda: 0.0 if 0.8 < context.time_s < 1.1 else payload_kg()

    ended = lowering(1.9, jolted=jolted)
    assert ended.status == "SUCCESS"
    assert ended.events[0].above_m == pytest.approx(1.9 - 1.94, abs=0.02)
    assert len(world.arm.stopped_s) == 2


def test_a_ground_that_never_comes_is_a_failure(lowering):
    ended = lowering(1.0)
    assert ended.status == "FAILURE"
    assert "still hangs in the jaws with 900 kg, 0.20 m below its place" in ended.reason
    assert ended.events == []


def test_a_stone_that_is_not_weighed_is_lowered_to_the_plan(lowering, world):
    ended = lowering(1.0, weighed=False)
    assert (ended.status, ended.events) == ("SUCCESS", [])
    assert ended.reason == "no monitor weighs the stone: lowered by 0.06 m to the plan"
    assert world.leaf_context.gripper()[2, 3] == pytest.approx(1.94, abs=1e-4)


def test_a_stone_without_a_way_down_is_not_lowered(lowering, stage, world):
    context = world.leaf_context
    context.weighed, context.payload = Weight(900.0, 20.0), 900.0
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=NO_WAY)
    ended = world.tick(LowerUntilDown, hold=world.hold, placement=placement(SLOTS[0]))
    assert (ended.status, ended.reason) == ("FAILURE", "no path down: the boom would hit stone 2")


def alignment(accepted, shift_m=0.1, reason="rmse 3 cm"):
    return Alignment(pose(t=np.array([shift_m, 0.0, 0.0])), accepted, reason, 0.03, 0.9)


@pytest.mark.parametrize(
    ("aligned", "found", "method", "moved_m"),
    [
        (alignment(True), None, "alignment", 0.1),
        (alignment(False), alignment(True, 0.7), "registration", 0.7),
        (alignment(True, 0.6), alignment(True, 0.7), "registration", 0.7),
        (alignment(False), alignment(False), "alignment", 0.0),
    ],
    ids=["aligned", "registered", "shifted too far", "refused"],
)
def test_a_relocated_stone_is_realigned_or_its_pose_kept(
    stage, world, database, aligned, found, method, moved_m
):
    database.release(1, world.hold.T_map_gripper, 3.0, StoneState.PLACED)
    aligner, registrar = (
        stage.Scripted(Aligner, align=aligned),
        stage.Scripted(Registrar, find=found),
    )
    plugins(world).update(alignment=aligner, registration=registrar)
    shown = pose(t=np.array([moved_m, 0.0, 0.0]))
    plugins(world)["mapping"].add_surface(transform(shown, database.stone(1).points_map))
    ended = world.tick(RelocateAndRealign, stone=1)
    assert ended.status == ("SUCCESS" if moved_m else "FAILURE")
    (event,) = ended.events
    assert isinstance(event, StoneRealigned)
    assert (event.accepted, event.method) == (moved_m > 0, method)
    assert (event.reason == "") == (moved_m > 0)
    assert database.stone(1).T_map_object[0, 3] == pytest.approx(5.0 + moved_m, abs=0.05)
    assert len(registrar.calls("find")) == (found is not None)
    np.testing.assert_array_equal(
        aligner.calls("align")[0]["source"].points[:, 1:].mean(axis=0).round(1), [0.0, 0.3]
    )


def test_the_map_forgets_a_place_and_keeps_the_neighbours(world, database):
    before = plugins(world)["mapping"].cloud().points
    ended = world.tick(ForgetPlace, stone=2)
    assert ended.status == "SUCCESS"
    after = plugins(world)["mapping"].cloud().points
    (event,) = ended.events
    assert isinstance(event, PlaceForgotten)
    assert event.stone == 2
    assert event.removed_points == len(before) - len(after) + event.put_back_points > 100
    assert np.linalg.norm(after - database.stone(2).centroid_map, axis=1).min() > 0.9


@pytest.mark.parametrize("leaf", [ForgetPlace, FindAgain, RelocateAndRealign])
def test_a_stone_that_nobody_knows_is_an_error(stage, world, leaf):
    unused = {"alignment": Aligner, "registration": Registrar, "segmentation": Segmenter}
    plugins(world).update({name: stage.Scripted(kind) for name, kind in unused.items()})
    with pytest.raises(DataError, match="9"):
        world.tick(leaf, stone=9)


@pytest.fixture
def search(stage, world, database):
    """Return the stage with stone 2 in the map, 0.3 m beside where the database has it."""
    seen = database.stone(2).points_map + [0.3, 0.0, 0.0]
    plugins(world)["mapping"].add_surface(seen)
    part = Segment(0, seen, seen.mean(axis=0), np.ptp(seen, axis=0))
    flat = np.array([0.0, 0.0, 1.0, 0.0])
    world.segmented = Segmentation("map", (part,), Cloud("map", np.zeros((1, 3))), flat)
    world.empty = Segmentation("map", (), Cloud("map", np.zeros((1, 3))), flat)
    world.rest = (Cloud("map", np.zeros((1, 3))), flat)  # of a segmentation, beside its segments
    return world


def test_a_pushed_stone_is_found_by_its_model(stage, search, database):
    registrar = stage.Scripted(Registrar, find=alignment(True, 0.3))
    segmenter = stage.Scripted(Segmenter)
    plugins(search).update(registration=registrar, segmentation=segmenter)
    ended = search.tick(FindAgain, stone=2)
    assert (ended.status, ended.reason) == ("SUCCESS", "registration, rmse 3 cm")
    assert database.stone(2).T_map_object[0, 3] == pytest.approx(5.3, abs=0.05)
    (event,) = ended.events
    assert isinstance(event, StoneSoughtAgain)
    assert (event.stone, event.seen, event.method) == (2, (2,), "registration")
    (asked,) = registrar.calls("find")
    assert 250 < len(asked["model"].points) < 310  # the model of stone 2, thinned a little
    assert segmenter.calls("segment") == []


def test_what_registration_refuses_is_found_by_segmentation(stage, search, database):
    registrar = stage.Scripted(Registrar, find=alignment(False))
    segmenter = stage.Scripted(Segmenter, segment=search.segmented)
    plugins(search).update(registration=registrar, segmentation=segmenter)
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "SUCCESS"
    assert database.stone(2).centroid_map[0] == pytest.approx(5.3, abs=0.1)
    assert [(event.method, event.seen) for event in ended.events] == [("segmentation", (2,))]


@pytest.mark.parametrize("done", [StoneState.PLACED, StoneState.SET_ASIDE])
@pytest.mark.parametrize(("beside_m", "is_left_out"), [(0.5, True), (0.7, False)])
def test_a_segment_at_a_stone_that_is_done_is_not_taken_for_the_one_that_is_sought(
    stage, search, database, done, beside_m, is_left_out
):
    """Stone 1 lies in its slot; the only segment lies beside it, and no map shows stone 2."""
    database.set_state(1, done, 2.0)
    seen = database.stone(2).points_map.copy()
    place = database.stone(1).centroid_map + [0.0, beside_m, 0.0]
    seen += place - seen.mean(axis=0)
    part = Segment(0, seen, seen.mean(axis=0), np.ptp(seen, axis=0))
    offered = []
    observe = database.observe
    database.observe = lambda found, *rest: (offered.extend(found), observe(found, *rest))[1]
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=Segmentation("map", (part,), *search.rest)),
    )
    search.tick(FindAgain, stone=2)
    assert [one.id for one in offered] == ([] if is_left_out else [0])


def test_a_segment_at_a_stone_on_the_ground_or_at_the_sought_one_itself_is_offered(
    stage, search, database
):
    database.set_state(1, StoneState.ON_GROUND, 2.0)
    database.set_state(2, StoneState.PLACED, 2.0)
    parts = tuple(
        Segment(i, stone.points_map, stone.centroid_map, np.ptp(stone.points_map, axis=0))
        for i, stone in enumerate(database.stones())
    )
    segmented = Segmentation("map", parts, *search.rest)
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=segmented),
    )
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "SUCCESS"
    assert [event.seen for event in ended.events] == [(1, 2)]


def test_a_stone_that_is_gone_is_a_failure(stage, search, database):
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=search.empty),
    )
    # The map shows most of it where it was, so it is there, whatever the segmentation makes of it.
    assert search.tick(FindAgain, stone=2).status == "SUCCESS"
    bare = plugins(search)["mapping"].points
    plugins(search)["mapping"] = stage.PointMap(bare[bare[:, 2] <= 0.0])
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "FAILURE"
    assert ended.reason == "stone 2 was not found within 4.0 m of its last place"
    sought = [event for event in ended.events if isinstance(event, StoneSoughtAgain)]
    assert [event.seen for event in sought] == [()]
    assert database.stone(2).state is StoneState.LOST
    plugins(search)["mapping"] = stage.PointMap([])
    ended = search.tick(FindAgain, stone=2)
    assert (ended.status, ended.reason) == ("FAILURE", "the map shows nothing around stone 2")


def set_down(world, database, *, realigned=None):
    """Set stone 1 down as planned on slot 1; a realignment may show it elsewhere."""
    before = database.stone(1)
    database.release(1, world.hold.T_map_gripper, 5.0, StoneState.PLACED)
    if realigned is not None:
        database.realign(1, realigned, 6.0, "alignment")
    return Placement(SLOTS[0], world.hold.T_map_gripper, before.T_map_object)


def tilted(database, angle_rad):
    """Return the motion in the map that tips stone 1 over its centre."""
    centre = pose(t=database.stone(1).centroid_map)
    return centre @ pose(from_rpy(angle_rad, 0.0, 0.0)) @ inverse(centre)


def verified(ended):
    (event,) = (one for one in ended.events if isinstance(one, PlacementVerified))
    return event


def test_a_stone_that_is_seen_at_its_place_is_placed(world, database):
    planned = set_down(world, database, realigned=pose(t=np.array([0.05, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert ended.status == "SUCCESS"
    assert (verified(ended).seen, verified(ended).off_m) == ("placed", pytest.approx(0.05))
    assert verified(ended).turn_known
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(
    ("rule", "status", "state"),
    [
        ("correct", "FAILURE", StoneState.ON_GROUND),
        ("keep", "SUCCESS", StoneState.PLACED),
        ("set_aside", "SUCCESS", StoneState.SET_ASIDE),
    ],
)
def test_a_stone_that_stands_off_its_place_is_treated_by_the_missions_rule(
    world, database, rule, status, state
):
    planned = set_down(world, database, realigned=pose(t=np.array([0.36, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, settings={"otherwise": rule}, stone=1, placement=planned)
    assert ended.status == status
    assert "stone 1 is 0.36 m off its place" in ended.reason
    assert (verified(ended).seen, verified(ended).rule) == ("off", rule)
    assert database.stone(1).state is state


def test_a_stone_that_toppled_on_its_place_is_off(world, database):
    planned = set_down(world, database, realigned=tilted(database, np.radians(88)))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, "tilted by 88°" in ended.reason) == ("FAILURE", True)


def test_a_stone_that_turned_about_the_vertical_is_placed(world, database):
    centre = pose(t=database.stone(1).centroid_map)
    turn = centre @ pose(from_rpy(0.0, 0.0, 1.0)) @ inverse(centre)
    planned = set_down(world, database, realigned=turn)
    assert world.tick(VerifyPlacement, stone=1, placement=planned).status == "SUCCESS"


@pytest.mark.parametrize(
    ("rule", "status"), [("correct", "FAILURE"), ("keep", "SUCCESS"), ("set_aside", "SUCCESS")]
)
def test_a_stone_that_was_not_seen_is_lost_by_each_rule(world, database, rule, status):
    planned = set_down(world, database)
    ended = world.tick(VerifyPlacement, settings={"otherwise": rule}, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen, verified(ended).rule) == (status, "unseen", rule)
    assert "not seen where it was set down" in ended.reason
    assert [event.stone for event in ended.events if isinstance(event, StoneLost)] == [1]
    assert database.stone(1).state is StoneState.LOST


def test_a_lost_stone_that_a_second_look_shows_at_its_place_is_placed(world, database):
    planned = set_down(world, database)
    database.set_state(1, StoneState.LOST, 6.0)
    database.realign(1, pose(t=np.array([0.05, 0.0, 0.0])), 7.0, "registration")
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("SUCCESS", "placed")
    assert database.stone(1).state is StoneState.PLACED


def test_a_stone_seen_there_with_another_surface_has_turned(stage, world, database):
    planned = set_down(world, database)
    flat = stage.block(database.stone(1).centroid_map, size=(0.9, 0.3, 1.1), seed=4)
    database.observe([Segment(0, flat, flat.mean(axis=0), np.ones(3))], 6.0, False)
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("FAILURE", "off")
    assert "it has turned" in ended.reason
    assert not verified(ended).turn_known


def test_a_stone_that_had_turned_over_is_placed_by_its_new_surface_and_that_is_told(
    stage, world, database
):
    database.release(1, world.hold.T_map_gripper, 3.0, StoneState.ON_GROUND)
    flat = stage.block(database.stone(1).centroid_map, size=(0.9, 0.3, 1.1), seed=4)
    database.observe([Segment(0, flat, flat.mean(axis=0), np.ones(3))], 4.0, False)
    database.grasp(1, world.hold.T_map_gripper, 4.5)
    planned = set_down(world, database, realigned=pose(t=np.array([0.05, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("SUCCESS", "placed")
    assert not verified(ended).turn_known
    assert "by a surface that is not the one it was found with" in ended.reason


def test_a_placed_stone_that_is_seen_elsewhere_or_nowhere_is_lost(stage, world, database):
    set_down(world, database, realigned=pose())
    registrar = stage.Scripted(Registrar, find=alignment(False))
    for aligned, status, words in [
        (alignment(True, 0.1), "SUCCESS", "1 stones are seen"),
        (alignment(True, 0.4), "FAILURE", "stone 1 is 0.40 m off its place"),
    ]:
        aligner = stage.Scripted(Aligner, align=aligned)
        plugins(world).update(alignment=aligner, registration=registrar)
        place = database.stone(1)
        plugins(world)["mapping"].remove_sphere(place.centroid_map, 2 * place.reach_m)
        plugins(world)["mapping"].add_surface(aligned.apply(place.points_map))
        ended = world.tick(CheckPlaced)
        assert (ended.status, words in ended.reason) == (status, True)
    assert database.stone(1).state is StoneState.LOST
    database.set_state(1, StoneState.PLACED, 8.0)
    plugins(world)["alignment"] = stage.Scripted(Aligner, align=alignment(False))
    ended = world.tick(CheckPlaced)
    assert (ended.status, "is not seen at its place" in ended.reason) == ("FAILURE", True)


def test_a_placed_stone_of_which_a_sparse_map_shows_a_little_is_in_doubt_and_not_lost(
    stage, world, database
):
    set_down(world, database, realigned=pose())
    own = database.stone(1).points_map
    few = own[own[:, 2] > np.median(own[:, 2])][::8]
    refused = alignment(False)
    plugins(world).update(
        mapping=stage.PointMap(np.vstack([few, own[own[:, 2] < own[:, 2].min() + 0.1]])),
        alignment=stage.Scripted(Aligner, align=refused),
        registration=stage.Scripted(Registrar, find=refused),
    )
    ended = world.tick(CheckPlaced)
    assert (ended.status, ended.reason) == (
        "SUCCESS",
        "0 stones are seen at their places, 1 are neither confirmed nor refuted",
    )
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(("is_aligned", "status"), [(True, "SUCCESS"), (False, "FAILURE")])
def test_a_placed_stone_that_a_later_one_has_pushed_down_is_asked_for_where_it_is(
    stage, world, database, is_aligned, status
):
    """The sparse map shows its form 4 cm away, which only the alignment knows."""
    set_down(world, database, realigned=pose())
    own = database.stone(1).points_map
    moved = pose(t=np.array([0.0, 0.0, -0.04]))
    few = own[own[:, 2] > np.median(own[:, 2])][::8]
    plugins(world).update(
        mapping=stage.PointMap(
            np.vstack([transform(moved, few), own[own[:, 2] < own[:, 2].min() + 0.1]])
        ),
        alignment=stage.Scripted(
            Aligner, align=replace(alignment(is_aligned), T_target_source=moved)
        ),
        registration=stage.Scripted(Registrar, find=alignment(False)),
    )
    assert world.tick(CheckPlaced).status == status


def test_a_placed_stone_beyond_the_map_is_not_lost(stage, world, database):
    set_down(world, database, realigned=pose())
    far = Cloud("map", np.array([[40.0, 0.0, 0.0]]))
    plugins(world).update(mapping=stage.Scripted(Mapper, cloud=far))
    ended = world.tick(CheckPlaced)
    assert (ended.status, ended.reason) == (
        "SUCCESS",
        "0 stones are seen at their places, 1 are beyond the map",
    )
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(("rim_m", "status"), [(-0.3, "SUCCESS"), (0.35, "FAILURE")])
def test_a_placed_stone_at_the_rim_of_the_map_is_lost_only_where_its_place_is_shown(
    stage, world, database, rim_m, status
):
    """The stone is gone, and the map ends short of its middle, or shows most of its place."""
    set_down(world, database, realigned=pose())
    x = database.stone(1).centroid_map[0]
    grid = np.stack(np.meshgrid(np.arange(0, 9, 0.1), np.arange(-9, 5, 0.1)), -1).reshape(-1, 2)
    shown = grid[grid[:, 0] < x + rim_m]
    ground = Cloud("map", np.column_stack([shown, np.zeros(len(shown))]))
    refused = alignment(False)
    plugins(world).update(
        mapping=stage.Scripted(Mapper, cloud=ground),
        alignment=stage.Scripted(Aligner, align=refused),
        registration=stage.Scripted(Registrar, find=refused),
    )
    ended = world.tick(CheckPlaced)
    assert ended.status == status, ended.reason
    lost = database.stone(1).state is StoneState.LOST
    assert lost == (status == "FAILURE")


def test_a_stone_that_fell_is_lost_and_one_that_slipped_is_not(world, database):
    world.leaf_context.troubles = [SLIP]
    world.tick(ReleaseStone, hold=world.hold)
    assert database.stone(1).state is StoneState.ON_GROUND
    database.grasp(1, world.hold.T_map_gripper, 6.0)
    world.leaf_context.troubles = [SLIP, DROP]
    ended = world.tick(ReleaseStone, hold=world.hold)
    assert database.stone(1).state is StoneState.LOST
    (event,) = (one for one in ended.events if isinstance(one, StoneLost))
    assert (event.stone, event.reason) == (1, "it fell: 12 kg left of 900 kg")


def test_nothing_is_sought_while_no_stone_is_lost(stage, search, database):
    registrar = stage.Scripted(Registrar)
    plugins(search)["registration"] = registrar
    assert search.tick(FindLost).status == "SUCCESS"
    assert registrar.asked == []


def test_a_lost_stone_keeps_its_identity_where_it_is_found(stage, search, database):
    """The stone fell 2.4 m away from its last place, farther than another stone may be."""
    database.set_state(2, StoneState.LOST, 5.0)
    fallen = stage.block((6.8, 1.4, 0.3), size=(0.8, 1.0, 0.6), seed=5)
    part = Segment(0, fallen, fallen.mean(axis=0), np.ones(3))
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(
            Segmenter, segment=[search.empty, Segmentation("map", (part,), *search.rest)]
        ),
    )
    ended = search.tick(FindLost)
    assert (ended.status, ended.reason) == ("FAILURE", "stones [2] are lost")
    assert search.tick(FindLost).status == "SUCCESS"
    assert [stone.id for stone in database.stones()] == [1, 2]
    assert database.stone(2).state is StoneState.ON_GROUND
    assert database.stone(2).centroid_map[:2] == pytest.approx([6.8, 1.4], abs=0.1)


def test_no_grasp_is_planned_for_a_lost_stone(stage, search, database):
    database.set_state(2, StoneState.LOST, 5.0)
    plugins(search)["grasping"] = stage.Scripted(GraspPlanner)
    ended = search.tick(PlanGrasp, stone=2)
    assert (ended.status, "is lost" in ended.reason) == ("FAILURE", True)


def test_a_lost_stone_that_is_set_aside_stays_lost(world, database):
    database.release(1, world.hold.T_map_gripper, 5.0, StoneState.LOST)
    world.leaf_context.first_failure = lambda: "a slip"
    ended = world.tick(SetAside, stone=1)
    assert ended.status == "SUCCESS"
    assert ended.events[0].reason == "every attempt failed: first, a slip; last, no way there"
    assert database.stone(1).state is StoneState.LOST


def test_a_stone_that_hangs_in_the_opened_jaws_is_not_placed(world, database):
    planned = set_down(world, database, realigned=pose())
    world.leaf_context.weighed, world.leaf_context.payload = Weight(1500.0, 30.0), 1450.0
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, "hangs in the jaws with 1450 kg" in ended.reason) == ("FAILURE", True)
    world.leaf_context.payload = 40.0
    assert world.tick(VerifyPlacement, stone=1, placement=planned).status == "SUCCESS"


def test_what_was_weighed_is_kept_with_the_stone(world, database):
    world.leaf_context.weighed = Weight(1500.0, 30.0)
    ended = world.tick(ReleaseStone, hold=world.hold, placement=placement(SLOTS[0]))
    assert [type(event).__name__ for event in ended.events] == ["StoneReleased", "StoneWeighed"]
    stone = database.stone(1)
    assert (stone.weight, stone.mass_kg) == (Weight(1500.0, 30.0), 1500.0)
    assert stone.mass_source == "weighed, ± 30 kg"
    assert database.stone(2).weight is None
