"""Which goals MoveBase asks the planner for, and when it does not ask at all."""

import numpy as np
import pytest
from pydantic import ValidationError

from executive.behaviours.move_base import MoveBase, MoveBaseSettings
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.interfaces.driving import DrivePlanner
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.messages.base_state import BaseState
from executive.messages.drive import DrivePlan, DriveTrouble
from executive.messages.region import Region
from executive.messages.request import MotionPlan
from executive.messages.stone import Stone, StoneState
from executive.messages.trajectory import JointTrajectory

AT, YAW = np.array([3.0, -1.0]), 0.4  # where the machine stands
NO_PATH = np.zeros((0, 3))


@pytest.fixture
def world(stage):
    """Return a stage whose machine folds its arm and finds no way, after it was asked for one."""

    class Yard(stage.Stage):
        def tick(self, leaf=MoveBase, *, stone=None, **settings):
            return super().tick(leaf, settings=settings, stone=stone)

        def stands(self, at, yaw):
            T = pose(about_axis(np.array([0.0, 0.0, 1.0]), yaw), [*at, 0.9])
            still = BaseState(0.0, T, T, T, np.zeros(3), np.zeros(3), 1e-4 * np.eye(6), "GLOBAL")
            self.leaf_context.state = lambda: still

        def goals(self):
            (asked,) = self.leaf_context.plugins["driving"].calls("plan")
            return asked["request"].goals_map

    refusal = DrivePlan(None, DriveTrouble.BLOCKED, "a wall")
    yard = Yard(
        robot=stage.Scripted(Robot),
        mapping=stage.PointMap(np.zeros((1, 3))),
        objects=stage.Scripted(
            ObjectDatabase, stones=lambda: (), surroundings=lambda map_cloud, without: map_cloud
        ),
        driving=stage.Scripted(DrivePlanner, plan=refusal),
    )
    context = yard.leaf_context
    stay = np.stack([context.arm()] * 2)
    path = JointTrajectory(
        context.machine().arm_names, np.array([0.0, 0.1]), stay, np.zeros_like(stay)
    )
    planner = stage.Scripted(MotionPlanner, move_joints=MotionPlan(path, "", NO_PATH))
    context.plugins["motion"] = planner
    yard.stands(AT, YAW)
    return yard


def stone_at(x, y, state=StoneState.ON_GROUND):
    points = np.array([[x, y, 0.0], [x, y, 1.0]])
    return Stone(4, state, points, np.array([x, y, 0.5]), np.eye(4), True)


def turned(headings):
    """Return headings as points of the circle: some are the same but for whole turns."""
    return np.column_stack([np.cos(headings), np.sin(headings)])


def test_the_heading_of_the_way_is_wanted_first_then_the_present_one_then_six_others(world):
    ended = world.tick(place=(3.0, 4.0))
    assert (ended.status, ended.reason) == ("FAILURE", "blocked: a wall")
    goals = world.goals()
    np.testing.assert_allclose(goals[:, :2], [[3.0, 4.0]] * 9)
    eighths = np.pi / 2 + np.pi / 4 * np.arange(1, 8)
    expected = [np.pi / 2, YAW, *eighths]  # the way leads straight along y
    np.testing.assert_allclose(turned(goals[:, 2]), turned(np.array(expected)), atol=1e-12)


def test_a_given_heading_is_the_only_one(world):
    world.tick(place=(8.0, 2.0), heading=-0.3)
    np.testing.assert_allclose(world.goals(), [[8.0, 2.0, -0.3]])


def test_a_region_is_entered_at_its_middle(world):
    corners = np.array([[6.0, 3.0], [10.0, 3.0], [10.0, 5.0], [6.0, 5.0]])
    world.leaf_context.regions = {"yard": Region("yard", corners)}
    world.tick(to="yard", heading=1.0)
    np.testing.assert_allclose(world.goals(), [[8.0, 4.0, 1.0]])


def test_a_stone_is_faced_from_eight_sides_the_nearest_first(world):
    world.leaf_context.plugins["objects"].answers(stone=stone_at(3.0, 9.0))
    world.tick(stone=4, distance=5.0)
    goals = world.goals()
    np.testing.assert_allclose(goals[0, :2], [3.0, 4.0], atol=1e-12)
    away = goals[:, :2] - [3.0, 9.0]
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), 5.0)
    np.testing.assert_allclose(turned(goals[:, 2]), -away / 5.0, atol=1e-12)  # it looks at it
    distances = np.linalg.norm(goals[:, :2] - AT, axis=1)
    assert (np.diff(distances) > -1e-9).all()
    assert len(np.unique(goals[:, :2].round(6), axis=0)) == len(goals) == 8


def test_about_a_stone_the_heading_may_be_given(world):
    world.leaf_context.plugins["objects"].answers(stone=stone_at(3.0, 9.0))
    world.tick(stone=4, heading=0.7)
    goals = world.goals()
    np.testing.assert_allclose(goals[:, 2], 0.7)
    away_m = np.linalg.norm(goals[:, :2] - [3.0, 9.0], axis=1)
    np.testing.assert_allclose(away_m, 0.6 * world.leaf_context.machine().reach_m)


@pytest.mark.parametrize(
    ("off", "turned_rad", "is_there"),
    [((0.14, 0.0), 0.0, True), ((0.16, 0.0), 0.0, False), ((0.0, 0.0), 0.04, True),
     ((0.0, 0.0), -0.06, False), ((0.0, 0.0), 2 * np.pi, True)],
)  # fmt: skip
def test_it_stands_there_already_within_15_cm_and_3_degrees(world, off, turned_rad, is_there):
    world.stands(np.array([8.0, 2.0]) + off, YAW + turned_rad)
    ended = world.tick(place=(8.0, 2.0), heading=YAW)
    assert (ended.status == "SUCCESS") is is_there
    assert (ended.reason == "the machine stands there already") is is_there
    assert len(world.leaf_context.plugins["driving"].calls("plan")) == (not is_there)


def test_with_a_stone_in_the_jaws_it_does_not_drive(world):
    held = stone_at(1.0, 1.0, StoneState.HELD)
    world.leaf_context.plugins["objects"].answers(stones=lambda: (stone_at(5.0, 5.0), held))
    ended = world.tick(place=(8.0, 2.0))
    told = "stone 4 is held: put it down before driving"
    assert (ended.status, ended.reason, ended.is_final) == ("FAILURE", told, True)
    assert world.leaf_context.plugins["motion"].asked == []


def test_an_arm_that_cannot_be_folded_ends_it(world):
    no_way = MotionPlan(None, "the boom would hit the cabin", NO_PATH)
    world.leaf_context.plugins["motion"].answers(move_joints=no_way)
    away = world.leaf_context.machine().posture("scan") + 0.5
    world.leaf_context.positions = lambda time_s: away
    ended = world.tick(place=(8.0, 2.0))
    assert ended.status == "FAILURE"
    assert ended.reason.startswith("refused: ")
    assert "the boom would hit the cabin" in ended.reason
    (event,) = ended.events
    assert event.trouble is DriveTrouble.REFUSED
    assert world.leaf_context.plugins["driving"].calls("plan") == []


def test_a_place_and_a_region_are_not_given_together():
    with pytest.raises(ValidationError, match="give 'place' or 'to', not both"):
        MoveBaseSettings(place=(1.0, 2.0), to="yard")


def test_a_machine_that_does_not_drive_is_refused_when_the_mission_is_read(world):
    machine = world.leaf_context.machine()
    settings = MoveBaseSettings(place=(1.0, 2.0))
    assert list(settings.refusals(machine)) == []
    (refusal,) = settings.refusals(machine.model_copy(update={"driving": None}))
    assert refusal.message == f"{machine.name} does not drive (driving of its robot.yaml)"
