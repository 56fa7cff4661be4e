"""MoveBase against a scripted planner and a robot that does as it is told."""

import numpy as np
import pytest
from executive_plugins.driving.planner import Dubins
from executive_plugins.driving.settings import DubinsSettings
from executive_plugins.robot.base_driver import BaseDriver

from executive.behaviours.move_base import MoveBase, MoveBaseSettings
from executive.errors import RobotError
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.command import Drive
from executive.messages.drive import DrivePlan, DriveTrouble
from executive.messages.region import Region
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from executive.testing.exercises.driving import level_ground

MACHINE = load_machine("m545")
SCAN = MACHINE.posture("scan")


class Rolling:
    """A robot whose chassis rolls, and which answers for the state."""

    def __init__(self):
        self.driver, self.stops, self.stuck = BaseDriver(MACHINE), 0, False

    def command(self, command):
        if isinstance(command, Drive):
            self.driver.command(command, SCAN, arm_moves=False)

    def stop(self):
        self.stops += 1
        self.driver.stop()

    def tick(self, dt_s):
        if not self.stuck:
            self.driver.advance(dt_s)


class Empty:
    def __init__(self, *stones):
        self._stones = stones

    def stones(self):
        return self._stones

    def surroundings(self, cloud, without=None):
        return cloud


class Motion(MotionPlanner):
    def reach(self, T_base_gripper, seed):
        return None

    def move(self, request):
        raise NotImplementedError

    def swing(self, start, angle_rad, duration_s, around=None):
        raise NotImplementedError

    def move_joints(self, request):
        times = np.array([0.0, 0.1])
        rest = np.zeros((2, len(SCAN)))
        path = JointTrajectory(MACHINE.arm_names, times, np.array([SCAN, SCAN]), rest)
        return MotionPlan(path, "", np.zeros((0, 3)))


class Map:
    def __init__(self, points):
        self.points = points

    def cloud(self):
        return Cloud("map", self.points)


def on_wheels(fakes, points=None, status=lambda time_s: "GLOBAL", tilt_rad=0.0, **plugins):
    """Return a context whose state is where the robot has rolled to."""
    robot = Rolling()

    class Context(fakes.Context):
        def now_s(self):
            return self.time_s

        def state(self):
            x, y, yaw = robot.driver.pose_map
            T = pose(about_axis(np.array([0.0, 0.0, 1.0]), yaw), np.array([x, y, 0.9]))
            T = T @ pose(about_axis(np.array([0.0, 1.0, 0.0]), tilt_rad if x > 2 else 0.0))
            speed = robot.driver.speed_m_s * np.array([np.cos(yaw), np.sin(yaw), 0.0])
            tight = 1e-4 * np.eye(6)
            now = status(self.time_s)
            return BaseState(self.time_s, T, T, T, speed, np.zeros(3), tight, now)

        @property
        def time_s(self):
            return self._time_s

        @time_s.setter
        def time_s(self, value):
            if value > getattr(self, "_time_s", 0.0):
                robot.tick(value - self._time_s)
            self._time_s = value

    ground = level_ground().points if points is None else points
    own = {
        "robot": robot,
        "motion": Motion(),
        "mapping": Map(ground),
        "objects": Empty(),
        "driving": Dubins(DubinsSettings(), MACHINE),
    }
    return Context(**(own | plugins)), robot


def leaf(context, **settings):
    return MoveBase(MoveBaseSettings.model_validate(settings), context)


def kinds(context):
    return [event.kind for event in context.events]


def test_it_drives_to_a_place_and_stands_there(fakes):
    context, robot = on_wheels(fakes)
    outcome = fakes.finish(leaf(context, place=[8, 1], heading=0.2))
    assert outcome.success, outcome.reason
    np.testing.assert_allclose(robot.driver.pose_map, [8.0, 1.0, 0.2], atol=0.1)
    assert robot.driver.speed_m_s == 0.0
    assert kinds(context) == ["drive_started", "drive_ended"]


def test_it_drives_into_a_region_with_any_heading(fakes):
    context, robot = on_wheels(fakes)
    corners = np.array([[6.0, 3.0], [10.0, 3.0], [10.0, 5.0], [6.0, 5.0]])
    context.regions = {"yard": Region("yard", corners)}
    assert fakes.finish(leaf(context, to="yard")).success
    assert context.regions["yard"].contains(robot.driver.pose_map[None, :2])[0]


def test_it_drives_within_reach_of_a_stone(fakes):
    class One(Empty):
        def stone(self, stone_id):
            return type("Stone", (), {"centroid_map": np.array([14.0, 2.0, 0.4])})()

    context, robot = on_wheels(fakes, objects=One())
    assert fakes.finish(leaf(context), stone=3).success
    away_m = np.linalg.norm(robot.driver.pose_map[:2] - [14.0, 2.0])
    assert away_m == pytest.approx(0.6 * MACHINE.reach_m, abs=0.1)


def test_where_it_stands_already_it_does_not_drive(fakes):
    context, robot = on_wheels(fakes)
    assert fakes.finish(leaf(context, place=[0.05, -0.02], heading=0.01)).success
    np.testing.assert_array_equal(robot.driver.pose_map, 0.0)
    assert kinds(context) == []


def test_without_a_goal_or_with_two_it_fails_for_good(fakes):
    for settings, inputs in (({}, {}), ({"place": [1, 1]}, {"stone": 1})):
        outcome = fakes.finish(leaf(on_wheels(fakes)[0], **settings), **inputs)
        assert not outcome.success
        assert outcome.is_final
        assert "one goal" in outcome.reason


def failure(fakes, context, **settings):
    outcome = fakes.finish(leaf(context, **({"place": [8, 0], "heading": 0} | settings)))
    assert not outcome.success
    return context.events[-1].trouble, outcome.reason


def test_a_way_that_is_blocked_is_not_begun(fakes):
    x, y, z = np.meshgrid(np.arange(7, 9, 0.1), np.arange(-1, 1, 0.1), np.arange(0, 1.5, 0.1))
    stone = np.c_[x.ravel(), y.ravel(), z.ravel()]
    context, robot = on_wheels(fakes, np.vstack([level_ground().points, stone]))
    assert failure(fakes, context)[0] is DriveTrouble.BLOCKED
    np.testing.assert_array_equal(robot.driver.pose_map, 0.0)


def test_a_machine_that_does_not_move_is_stopped(fakes):
    context, robot = on_wheels(fakes)
    robot.stuck = True
    trouble, reason = failure(fakes, context)
    assert trouble is DriveTrouble.NOT_MOVING
    assert "not moved on for 3" in reason
    assert robot.stops == 1


def test_an_estimate_that_is_doubted_brakes_at_once_and_ends_the_drive_if_it_lasts(fakes):
    context, robot = on_wheels(fakes, status=lambda t: "GLOBAL" if t < 6 else "SUSPECT")
    trouble, reason = failure(fakes, context)
    assert trouble is DriveTrouble.ESTIMATE
    assert "SUSPECT" in reason
    assert robot.driver.speed_m_s == 0.0  # it stood before the patience was over
    assert robot.stops == 1


def test_an_estimate_that_recovers_lets_the_machine_drive_on(fakes):
    context, _ = on_wheels(fakes, status=lambda t: "SUSPECT" if 6 < t < 8 else "GLOBAL")
    assert fakes.finish(leaf(context, place=[8, 0])).success


def test_a_chassis_that_leans_too_far_is_stopped(fakes):
    context, robot = on_wheels(fakes, tilt_rad=0.5)
    assert failure(fakes, context)[0] is DriveTrouble.TOO_STEEP
    assert 2.0 < robot.driver.pose_map[0] < 3.0


def test_a_machine_off_its_path_is_stopped(fakes):
    context, robot = on_wheels(fakes)
    steps = leaf(context, place=[8, 0], heading=0.0).run()
    answer, end = None, None
    try:
        while context.time_s < 60:
            waiting = steps.send(answer)
            answer = waiting.result() if waiting is not None else None
            context.time_s += fakes.TICK_S
            if robot.driver.pose_map[0] > 2.0 and robot.driver.pose_map[1] == 0.0:
                robot.driver.pose_map = robot.driver.pose_map + [0.0, 1.0, 0.0]
    except StopIteration as stop:
        end = stop.value
    assert end is not None
    assert context.events[-1].trouble is DriveTrouble.OFF_PATH


def test_a_robot_that_refuses_ends_the_drive(fakes):
    context, robot = on_wheels(fakes)

    def command(given):
        raise RobotError("a safe stop is latched")

    robot.command = command
    with pytest.raises(RobotError, match="latched"):  # by the fold, as in every leaf of the arm
        fakes.finish(leaf(context, place=[8, 0]))


def test_a_cancelled_drive_brakes(fakes):
    context, robot = on_wheels(fakes)
    steps, answer = leaf(context, place=[8, 0]).run(), None
    while context.time_s < 6:
        waiting = steps.send(answer)
        answer = waiting.result() if waiting is not None else None
        context.time_s += fakes.TICK_S
    assert robot.driver.speed_m_s > 0
    steps.close()
    assert robot.stops == 1


def test_a_refused_plan_says_why(fakes):
    class Nowhere(Dubins):
        def plan(self, request):
            return DrivePlan(None, DriveTrouble.UNSEEN, "the ground there is dark")

    context, _ = on_wheels(fakes, driving=Nowhere(DubinsSettings(), MACHINE))
    assert failure(fakes, context) == (DriveTrouble.UNSEEN, "unseen: the ground there is dark")


@pytest.mark.parametrize(("place", "status"), [((8, 0), "SUCCESS"), ((80, 0), "FAILURE")])
def test_it_is_ticked_in_a_tree(fakes, stage, place, status):
    scene = stage.Stage()
    scene.leaf_context, robot = on_wheels(fakes)
    ended = scene.tick(MoveBase, settings={"place": place}, stone=None)
    assert ended.status == status, ended.reason
    assert (robot.driver.pose_map[0] > 7.9) == (status == "SUCCESS")


def test_the_arm_is_folded_into_the_posture_that_the_machine_drives_in(fakes):
    context, _ = on_wheels(fakes)
    carrying = MACHINE.driving.model_copy(update={"posture": "carry"})
    folded = leaf(context, place=[8, 1])._folded(MACHINE.model_copy(update={"driving": carrying}))
    np.testing.assert_array_equal(folded, MACHINE.posture("carry"))
    assert not np.array_equal(folded, SCAN)
