"""Leaves that take hold of a stone, ticked in a tree to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.close_gripper import CloseGripper
from executive.behaviours.execute_trajectory import ExecuteTrajectory
from executive.behaviours.open_gripper import OpenGripper
from executive.behaviours.plan_grasp import PlanGrasp
from executive.behaviours.plan_pick import PlanPick
from executive.behaviours.plan_retreat import PlanRetreat
from executive.behaviours.wait_for_room import WaitForRoom
from executive.events.stone import AttemptStarted, GraspsPlanned, JawsClosedOnNothing, StoneGrasped
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.messages.command import Follow, MoveJaws
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.request import MotionPlan
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory

NO_PATH = np.zeros((0, 3))
NO_WAY = MotionPlan(None, "the boom would hit stone 2", NO_PATH)


def grasp(x):
    return Grasp(pose(t=np.array([x, 0.0, 1.0])), 1.2, 0.5, {"slip_m": 0.1})


@pytest.fixture
def world(stage, database):
    """Return a stage with map, database, and a planner that finds no path until a test says so."""
    stand = stage.Stage(
        robot=stage.Scripted(Robot),
        mapping=stage.PointMap(np.vstack([stone.points_map for stone in database.stones()])),
        objects=database,
        motion=stage.Scripted(MotionPlanner, move=NO_WAY),
    )
    names, start = stand.leaf_context.machine().arm_names, stand.leaf_context.arm()
    position = np.stack([start, start + 0.1])
    stand.path = JointTrajectory(names, np.array([0.0, 1.0]), position, np.zeros_like(position))
    stand.found = MotionPlan(stand.path, "", NO_PATH)
    still = replace(stand.path, position=np.stack([start, start]))
    stand.stay = MotionPlan(still, "", NO_PATH)  # as the arm of this stage does
    return stand


def plugins(stand):
    return stand.leaf_context.plugins


def commands(stand):
    return [arguments["command"] for arguments in plugins(stand)["robot"].calls("command")]


def test_grasps_are_planned_on_the_map_and_the_models(stage, world, database):
    plan = GraspPlan((grasp(5.0), grasp(5.1)), {"too_steep": 3})
    planner = plugins(world)["grasping"] = stage.Scripted(GraspPlanner, plan=plan)
    ended = world.tick(PlanGrasp, stone=1)
    assert (ended.status, ended.reason) == ("SUCCESS", "2 grasps")
    assert ended.outputs == {"grasps": list(plan.grasps)}
    (asked,) = planner.calls("plan")
    assert asked["target"].id == 1
    assert asked["cloud"].frame == "map"
    (event,) = ended.events
    assert isinstance(event, GraspsPlanned)
    assert (event.stone, event.grasps, event.refused) == (1, 2, {"too_steep": 3})


@pytest.mark.parametrize("is_final", [True, False])
def test_a_stone_without_a_grasp_is_a_failure_with_the_reasons(stage, world, is_final):
    plan = GraspPlan((), {"too_heavy": 1}, is_final)
    plugins(world)["grasping"] = stage.Scripted(GraspPlanner, plan=plan)
    ended = world.tick(PlanGrasp, stone=1)
    assert (ended.status, ended.is_final) == ("FAILURE", is_final)
    assert ended.reason == "no grasp of stone 1: 1 too_heavy"
    assert [event.grasps for event in ended.events] == [0]


def test_the_first_grasp_with_a_path_is_picked(stage, world):
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=[NO_WAY, world.found])
    grasps = [grasp(5.0), grasp(5.5), grasp(6.0)]
    ended = world.tick(PlanPick, stone=1, grasps=grasps)
    assert ended.status == "SUCCESS"
    assert ended.outputs["grasp"] is grasps[1]
    assert ended.outputs["grasps"] == grasps[2:]
    assert ended.outputs["trajectory"] is world.path
    (event,) = ended.events
    assert isinstance(event, AttemptStarted)
    assert (event.stone, event.passed_over) == (1, ("the boom would hit stone 2",))
    first, _ = (asked["request"] for asked in plugins(world)["motion"].calls("move"))
    np.testing.assert_array_equal(first.T_map_gripper, grasps[0].T_map_gripper)
    assert first.jaw_rad == world.leaf_context.machine().gripper.open_rad
    assert first.held_gripper is None


def test_no_path_to_any_grasp_is_a_failure_that_names_the_obstacle(world):
    ended = world.tick(PlanPick, stone=1, grasps=[grasp(5.0), grasp(5.5)])
    assert ended.status == "FAILURE"
    assert "the boom would hit stone 2" in ended.reason
    assert ended.outputs["grasps"] == []
    assert ended.events == []


def test_the_gripper_opens_fully(world):
    open_rad = world.leaf_context.machine().gripper.open_rad
    world.leaf_context.jaw = lambda t: min(open_rad, 0.5 * t)
    ended = world.tick(OpenGripper)
    assert ended.status == "SUCCESS"
    (command,) = commands(world)
    assert isinstance(command, MoveJaws)
    assert command.position_rad == open_rad


def test_jaws_that_do_not_open_are_a_failure(world):
    world.leaf_context.jaw = lambda t: 0.2
    ended = world.tick(OpenGripper)
    assert ended.status == "FAILURE"
    assert "the jaws stopped at 0.20 rad" in ended.reason


def test_jaws_wait_beside_a_stone_as_long_as_they_may(world, database):
    gripper, point = world.leaf_context.machine().gripper, database.stones()[0].points_map[0]
    T = pose(from_rpy(0.0, np.pi / 2, 0.0))
    T[:3, 3] = point - T[:3, :3] @ gripper.tips(gripper.open_rad)[0]
    world.leaf_context.gripper = lambda: T
    ended = world.tick(WaitForRoom, settings={"most": 0.2})
    assert ended.status == "SUCCESS"
    assert ended.reason.startswith("no room for open jaws after 0.2")


def test_jaws_far_from_all_stones_do_not_wait(world):
    world.leaf_context.gripper = lambda: pose(t=np.array([50.0, 0.0, 9.0]))
    ended = world.tick(WaitForRoom)
    assert (ended.status, ended.reason) == ("SUCCESS", "")


def test_a_trajectory_is_followed_to_its_end(world):
    first, last = world.path.position
    world.leaf_context.positions = lambda t: first + (last - first) * min(t, 1.0)
    ended = world.tick(ExecuteTrajectory, trajectory=world.path)
    assert ended.status == "SUCCESS"
    (command,) = commands(world)
    assert isinstance(command, Follow)
    assert command.trajectory is world.path
    assert plugins(world)["robot"].calls("stop") == []


def test_an_arm_that_does_not_move_is_stopped_and_a_failure(world):
    ended = world.tick(ExecuteTrajectory, trajectory=world.path)
    assert ended.status == "FAILURE"
    assert "0.100 off its goal" in ended.reason
    assert len(plugins(world)["robot"].calls("stop")) == 1


def test_a_stone_in_the_jaws_is_held(world, database):
    world.leaf_context.jaw = lambda t: max(0.5, 0.9 - t)
    before, own = len(plugins(world)["mapping"].cloud()), len(database.stone(1).points_map)
    ended = world.tick(CloseGripper, settings={"force": 5000.0}, stone=1)
    assert ended.status == "SUCCESS"
    hold = ended.outputs["hold"]
    assert (hold.stone_id, hold.jaw_rad) == (1, pytest.approx(0.5))
    np.testing.assert_array_equal(hold.T_map_gripper, world.leaf_context.gripper())
    assert database.stone(1).state is StoneState.HELD
    (command,) = commands(world)
    assert (command.position_rad, command.force_n) == (0.0, 5000.0)
    (event,) = ended.events
    assert isinstance(event, StoneGrasped)
    assert (event.stone, event.removed_points) == (1, own)
    assert len(plugins(world)["mapping"].cloud()) == before - own
    assert plugins(world)["mapping"].masks[0] > 0.5  # the stone's reach: it is a metre long
    assert world.leaf_context.holds == ["begin"]


def test_jaws_that_close_on_nothing_are_a_failure(world, database):
    world.leaf_context.jaw = lambda t: max(0.0, 0.9 - t)
    ended = world.tick(CloseGripper, stone=1)
    assert ended.status == "FAILURE"
    assert "nothing is between them" in ended.reason
    (event,) = ended.events
    assert isinstance(event, JawsClosedOnNothing)
    assert event.stone == 1
    assert database.stone(1).state is StoneState.ON_GROUND
    assert world.leaf_context.holds == plugins(world)["mapping"].masks == []


@pytest.mark.parametrize(
    ("hangs", "why", "raises"),
    [
        (0.1, "nothing is between them: ", 1),
        (0.3, "", 1),  # whether it hangs free is for a trial lift
        (None, "nothing is between them", 0),
    ],
)
def test_closed_jaws_hold_a_stone_that_hangs_within_them(
    stage, world, database, hangs, why, raises
):
    """They have met below it, and are raised to weigh it; the hold is where they have closed."""
    context = world.leaf_context
    context.jaw = lambda t: max(0.0, 0.9 - t)
    context.payload = None if hangs is None else hangs * database.stone(1).mass_kg
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.stay)
    ended = world.tick(CloseGripper, stone=1)
    assert len(motion.calls("move")) == raises
    if raises:
        asked = motion.calls("move")[0]["request"]
        assert asked.T_map_gripper[2, 3] == pytest.approx(context.gripper()[2, 3] + 0.15)
        assert asked.jaw_rad == 0.0
    if why:
        assert ended.status == "FAILURE"
        assert ended.reason.startswith(f"the jaws closed to 0.00 rad: {why}")
        assert database.stone(1).state is StoneState.ON_GROUND
        return
    assert ended.status == "SUCCESS"
    assert ended.outputs["hold"].jaw_rad == 0.0
    assert database.stone(1).state is StoneState.HELD
    assert context.holds == ["begin"]


def test_closed_jaws_that_cannot_be_raised_are_told_so(stage, world, database):
    context = world.leaf_context
    context.jaw, context.payload = lambda t: max(0.0, 0.9 - t), database.stone(1).mass_kg
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=NO_WAY)
    ended = world.tick(CloseGripper, stone=1)
    assert ended.status == "FAILURE"
    assert "whether a stone is within them is not known: no way up" in ended.reason


def test_the_retreat_is_as_high_as_there_is_a_path(stage, world):
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=[NO_WAY, world.found])
    ended = world.tick(PlanRetreat, settings={"height": 1.5})
    assert ended.status == "SUCCESS"
    assert ended.outputs == {"trajectory": world.path}
    z = world.leaf_context.gripper()[2, 3]
    first, second = (asked["request"] for asked in plugins(world)["motion"].calls("move"))
    assert first.T_map_gripper[2, 3] == pytest.approx(z + 1.5)
    assert z < second.T_map_gripper[2, 3] < z + 1.5
    assert second.leave_m == pytest.approx(second.T_map_gripper[2, 3] - z)


def test_the_retreat_turns_the_cabin_at_its_top(stage, world):
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanRetreat, settings={"height": 1.5, "turn": 0.2})
    assert (ended.status, ended.reason) == ("SUCCESS", "1.5 m up, turned by 11°")
    T_map_gripper = world.leaf_context.gripper()
    (asked,) = (one["request"] for one in plugins(world)["motion"].calls("move"))
    moved = asked.T_map_gripper @ inverse(T_map_gripper)  # about the machine, which stands at 0
    np.testing.assert_allclose(moved, pose(from_rpy(0.0, 0.0, 0.2), [0.0, 0.0, 1.5]), atol=1e-12)
    assert asked.leave_m == 1.5


def test_the_retreat_turns_about_the_machine_wherever_it_stands(stage, world):
    stands = pose(from_rpy(0.1, -0.05, 0.7), [2.0, -3.0, 0.4])
    state = replace(world.leaf_context.state(), T_map_base=stands)
    world.leaf_context.state = lambda: state
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanRetreat, settings={"height": 1.0, "turn": 0.3})
    assert ended.status == "SUCCESS"
    (asked,) = (one["request"] for one in plugins(world)["motion"].calls("move"))
    up_base = inverse(stands) @ pose(t=[0.0, 0.0, 1.0]) @ world.leaf_context.gripper()
    expected_base = pose(from_rpy(0.0, 0.0, 0.3)) @ up_base  # about the cabin's own axis
    np.testing.assert_allclose(inverse(stands) @ asked.T_map_gripper, expected_base, atol=1e-12)


def test_the_retreat_is_straight_where_no_turn_is_free(stage, world):
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=[NO_WAY, world.found])
    ended = world.tick(PlanRetreat, settings={"height": 1.5, "turn": 0.2})
    assert (ended.status, ended.reason) == ("SUCCESS", "1.5 m up")


def test_no_path_up_is_a_failure(world):
    ended = world.tick(PlanRetreat)
    assert (ended.status, ended.reason) == ("FAILURE", "no path up: the boom would hit stone 2")
