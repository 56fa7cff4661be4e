"""Leaves that bring the arm to a posture or the cabin to a heading, to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.go_to_posture import GoToPosture
from executive.behaviours.scan_from import ScanFrom
from executive.behaviours.turn_cabin import TurnCabin
from executive.events.site import SiteScanned
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.messages.command import Follow, SwitchLidars
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError

NO_PATH = np.zeros((0, 3))


class Follows:
    """Plans each motion as a straight line of two seconds; the joints follow what was planned."""

    def __init__(self, context):
        self.context, self.start = context, context.arm()
        self.begun_s = 0.0
        self.goal = self.start

    def plan(self, goal):
        now_s = self.context.time_s
        self.start, self.goal, self.begun_s = self.context.arm(), np.asarray(goal), now_s
        share = lambda t: float(np.clip((t - self.begun_s) / 2.0, 0.0, 1.0))
        start, end = self.start, self.goal
        self.context.positions = lambda t: start + (end - start) * share(t)
        position = np.stack([start, end])
        names = self.context.machine().arm_names
        trajectory = JointTrajectory(names, np.array([0.0, 2.0]), position, np.zeros_like(position))
        return MotionPlan(trajectory, "", NO_PATH)

    def move_joints(self, request):
        return self.plan(request.goal)

    def swing(self, start, angle_rad, duration_s, around=None):
        return self.plan(start)


@pytest.fixture
def site(stage, database):
    """Return a stage with a robot, a map, two stones, and a planner that plans what is asked."""
    motion = stage.Scripted(MotionPlanner)
    stand = stage.Stage(
        robot=stage.Scripted(Robot),
        motion=motion,
        mapping=stage.PointMap(np.ones((7, 3))),
        objects=database,
    )
    follows = Follows(stand.leaf_context)
    motion._answers |= {"move_joints": follows.move_joints, "swing": follows.swing}
    return stand


def request_of(site):
    (asked,) = site.leaf_context.plugins["motion"].calls("move_joints")
    return asked["request"]


def commands_of(site):
    return [asked["command"] for asked in site.leaf_context.plugins["robot"].calls("command")]


def test_the_cabin_turns_to_a_heading_of_the_chassis(site) -> None:
    before = site.leaf_context.arm()
    ended = site.tick(TurnCabin, settings={"heading": "90 deg"})
    assert ended.status == "SUCCESS"
    after = site.leaf_context.arm()
    assert after[0] == pytest.approx(np.pi / 2)
    np.testing.assert_array_equal(after[1:], before[1:])
    assert isinstance(commands_of(site)[0], Follow)
    assert len(request_of(site).obstacles) > 100  # the map and both stones


def test_a_heading_of_the_map_counts_the_yaw_of_the_chassis(site) -> None:
    context = site.leaf_context
    state = context.state()
    turned = pose(from_rpy(0.0, 0.0, 0.5))
    context.state = lambda: type(state)(
        0.0, turned, turned, np.eye(4), np.zeros(3), np.zeros(3), np.eye(6), "GLOBAL"
    )
    site.tick(TurnCabin, settings={"heading": 1.2, "relative_to": "map"})
    assert request_of(site).goal[0] == pytest.approx(0.7)


def test_the_cabin_stays_where_there_is_no_way(site) -> None:
    refused = MotionPlan(None, "travelling: collision of boom with the surroundings", NO_PATH)
    site.leaf_context.plugins["motion"]._answers["move_joints"] = refused
    ended = site.tick(TurnCabin, settings={"heading": 1.0})
    assert (ended.status, ended.is_final) == ("FAILURE", False)
    assert ended.reason == f"no way there: {refused.reason}"
    assert commands_of(site) == []


def test_a_held_stone_is_carried_around_obstacles(site, database) -> None:
    grasp = np.eye(4)
    database.grasp(1, grasp, 2.0)
    ended = site.tick(TurnCabin, settings={"heading": 1.0}, hold=Hold(1, grasp, 0.4))
    assert ended.status == "SUCCESS"
    request = request_of(site)
    assert len(request.held_gripper) > 300
    near = np.linalg.norm(request.obstacles.points - [5.0, 0.0, 0.3], axis=1)
    assert (near > 1.0).all()  # the held stone is no obstacle


def test_a_hold_of_a_stone_that_was_released_counts_no_more(site) -> None:
    ended = site.tick(TurnCabin, settings={"heading": 1.0}, hold=Hold(1, np.eye(4), 0.4))
    assert ended.status == "SUCCESS"
    assert request_of(site).held_gripper is None


def test_a_held_stone_is_swept_along(site, database) -> None:
    grasp = pose(t=np.array([5.0, 0.0, 1.0]))
    database.grasp(1, grasp, 2.0)
    site.leaf_context.weighed = Weight(900.0, 20.0)
    ended = site.tick(ScanFrom, settings={"heading": 1.0}, hold=Hold(1, grasp, 0.4))
    assert ended.status == "SUCCESS"
    (asked,) = site.leaf_context.plugins["motion"].calls("swing")
    held = transform(inverse(grasp), database.stone(1).points_map)
    np.testing.assert_allclose(asked["around"].held_gripper, held)
    assert asked["around"].held_kg == 940.0


def test_a_stone_that_was_released_is_not_swept_along(site) -> None:
    site.tick(ScanFrom, settings={"heading": 1.0}, hold=Hold(1, np.eye(4), 0.4))
    (asked,) = site.leaf_context.plugins["motion"].calls("swing")
    assert asked["around"].held_gripper is asked["around"].held_kg is None


@pytest.mark.parametrize("leaf", [TurnCabin, ScanFrom])
def test_a_stone_whose_hold_is_not_known_is_not_swung_about(site, database, leaf) -> None:
    database.grasp(2, np.eye(4), 2.0)
    ended = site.tick(leaf, settings={"heading": 1.0})
    assert (ended.status, ended.is_final) == ("FAILURE", True)
    assert ended.reason == "stone 2 is held, and the input 'hold' does not say how"
    assert commands_of(site) == []


def test_the_arm_goes_to_a_named_posture_and_the_cabin_stays(site) -> None:
    context = site.leaf_context
    start = context.arm()
    start[0] = 0.6
    context.positions = lambda t: start
    ended = site.tick(GoToPosture, settings={"posture": "carry"})
    assert ended.status == "SUCCESS"
    carry = context.machine().posture("carry")
    np.testing.assert_allclose(context.arm(), [0.6, *carry[1:]])


def test_the_arm_goes_to_joint_positions_and_the_other_joints_stay(site) -> None:
    before = site.leaf_context.arm()
    site.tick(GoToPosture, settings={"joints": {"J_BOOM": 1.1, "J_TELE": 0.5}})
    after, names = site.leaf_context.arm(), site.leaf_context.machine().arm_names
    changed = {n: b for n, a, b in zip(names, before, after, strict=True) if a != b}
    assert changed == pytest.approx({"J_BOOM": 1.1, "J_TELE": 0.5})


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"posture": "cary"}, "m545 has no posture 'cary'. Did you mean 'carry'?"),
        ({"joints": {"J_BOM": 1.0}}, "m545 has no joint 'J_BOM'. Did you mean 'J_BOOM'?"),
        ({"joints": {"J_BOOM": 9.0}}, "J_BOOM to 9: its range is "),
    ],
)
def test_what_the_machine_lacks_is_refused_for_good(site, settings, told) -> None:
    ended = site.tick(GoToPosture, settings=settings)
    assert (ended.status, ended.is_final) == ("FAILURE", True)
    assert ended.reason.startswith(told)
    assert commands_of(site) == []


def test_a_posture_or_joints_have_to_be_named() -> None:
    with pytest.raises(ValueError, match="give 'posture', 'joints' or both"):
        GoToPosture.Settings()


def test_a_scan_from_a_heading_turns_first_with_the_lidars_off(site) -> None:
    ended = site.tick(ScanFrom, settings={"heading": "-60 deg", "duration": 2.0})
    assert (ended.status, ended.reason) == ("SUCCESS", "7 points in the map")
    assert [type(command) for command in commands_of(site)] == [
        Follow,
        SwitchLidars,
        Follow,
        SwitchLidars,
    ]
    assert request_of(site).goal[0] == pytest.approx(-np.pi / 3)
    (swing,) = site.leaf_context.plugins["motion"].calls("swing")
    assert swing["start"][0] == pytest.approx(-np.pi / 3)
    assert [event.points for event in ended.events if isinstance(event, SiteScanned)] == [7]


def test_a_scan_from_a_heading_that_cannot_be_reached_does_not_begin(site) -> None:
    refused = MotionPlan(None, "blocked", NO_PATH)
    site.leaf_context.plugins["motion"]._answers["move_joints"] = refused
    ended = site.tick(ScanFrom, settings={"heading": 1.0})
    assert (ended.status, ended.reason) == ("FAILURE", "no way there: blocked")
    assert commands_of(site) == []


MISSION = """api: 1
mission: poses
extends: base
trees:
  main:
    sequence:
      - run: GoToPosture
        with: {posture: carry, joints: {J_BOOM: 0.5}}
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "carry,",
            "cary,",
            "8:25: error: posture: m545 has no posture 'cary'. Did you",
        ),
        ("J_BOOM:", "J_BOM:", "has no joint 'J_BOM'. Did you mean 'J_BOOM'?"),
        ("0.5", "50", "8:49: error: joints.J_BOOM: J_BOOM to 50: its range is"),
    ],
)
def test_what_the_machine_lacks_is_told_before_the_start(tmp_path, old, new, told):
    path = tmp_path / "poses.yaml"
    path.write_text(MISSION)
    assert load_mission(str(path), is_for_here=True).name == "poses"
    path.write_text(MISSION.replace(old, new))
    with pytest.raises(MissionFileError) as refused:
        load_mission(str(path), is_for_here=True)
    assert told in str(refused.value)
