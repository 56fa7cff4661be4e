"""A plan begins where the arm is: after a cancelled motion that is known only once the
arm stands.
"""

import re

import numpy as np
import pytest
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.plan_retreat import PlanRetreat, PlanRetreatSettings
from executive.behaviours.plan_set_down import PlanSetDown
from executive.behaviours.release_stone import ReleaseStone, ReleaseStoneSettings
from executive.behaviours.scan_swing import ScanSwing, ScanSwingSettings
from executive.config import NoSettings
from executive.geometry.pose import pose
from executive.leaf.rest import Rest
from executive.messages.cloud import Cloud
from executive.messages.command import START_TOLERANCE
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan
from executive.messages.stone import Stone, StoneState

STOPS_AFTER_S, SPEED = 1.5, 0.2  # of the boom [s], [rad/s]
POINTS = np.random.default_rng(0).uniform(-0.3, 0.3, (50, 3)) + [5, 0, 1.2]
GROUND = np.c_[np.random.default_rng(1).uniform([4, -1], [6, 1], (400, 2)), np.zeros(400)]


class Objects(SqliteObjects):
    """Keeps stones as they are given; scene verbs are the real ones."""

    def __init__(self):
        super().__init__(SqliteObjects.Settings())
        self.released = []

    def stone(self, stone_id):
        return Stone(
            stone_id,
            StoneState.HELD,
            POINTS,
            POINTS.mean(axis=0),
            pose(t=POINTS.mean(axis=0)),
            True,
        )

    def stones(self):
        return (self.stone(1),)

    def keep_grasp(self, stone_id, T_object_gripper, stamp_s):
        return self.stone(stone_id)

    def release(self, stone_id, T_map_gripper, stamp_s, state):
        self.released.append(T_map_gripper)
        return self.stone(stone_id)


class Mapper:
    def cloud(self):
        return Cloud("map", GROUND)

    def mask_held(self, radius_m):
        pass


class Planner:
    def __init__(self):
        self.starts = []

    def move(self, request):
        self.starts.append(request.start)
        return MotionPlan(None, "not asked here", np.zeros((0, 3)))

    def swing(self, start, angle_rad, duration_s, around=None):
        self.starts.append(start)
        return MotionPlan(None, "not asked here", np.zeros((0, 3)))


class Robot:
    def command(self, command):
        pass


@pytest.fixture
def stopping(fakes):
    """A context whose arm comes to rest after a while."""

    class Stopping(fakes.Context):
        def gripper(self):
            T = super().gripper()
            T[2, 3] -= self.positions(self.time_s)[1] - self.positions(0.0)[1]
            return T

    context = Stopping(
        objects=Objects(), mapping=Mapper(), motion=Planner(), robot=Robot(), monitoring=()
    )
    first = np.array(context.positions(0.0))
    boom = np.eye(len(first))[1]
    context.positions = lambda t: first + boom * SPEED * min(t, STOPS_AFTER_S)
    context.velocities = lambda t: boom * SPEED * (t < STOPS_AFTER_S)
    return context


HOLD = Hold(1, pose(t=np.array([5.0, 0.0, 2.0])), 0.4)


@pytest.mark.parametrize(
    ("make", "inputs"),
    [
        (lambda c: PlanSetDown(NoSettings(), c), {"hold": HOLD}),
        (lambda c: PlanRetreat(PlanRetreatSettings(), c), {}),
        (lambda c: ScanSwing(ScanSwingSettings(), c), {}),
    ],
)
def test_a_plan_waits_until_the_arm_stands(stopping, fakes, make, inputs):
    fakes.finish(make(stopping), **inputs)
    starts = stopping.plugins["motion"].starts
    assert starts
    np.testing.assert_allclose(starts, [stopping.positions(100.0)] * len(starts))


def test_a_stone_is_let_go_where_the_arm_has_come_to_rest(stopping, fakes):
    placement = Placement(Slot(1, np.zeros(3)), np.eye(4), np.eye(4))
    leaf = ReleaseStone(ReleaseStoneSettings(), stopping)
    assert fakes.finish(leaf, hold=HOLD, placement=placement).success
    (T_map_gripper,) = stopping.plugins["objects"].released
    assert T_map_gripper[2, 3] == pytest.approx(2.0 - SPEED * STOPS_AFTER_S)


def test_a_stone_that_is_just_let_go_is_believed_on_the_ground(stopping, fakes):
    assert fakes.finish(ReleaseStone(ReleaseStoneSettings(), stopping), hold=HOLD).success
    (T_map_gripper,) = stopping.plugins["objects"].released
    assert T_map_gripper[2, 3] == pytest.approx(HOLD.T_map_gripper[2, 3] - POINTS[:, 2].min())


def shaking(context, amplitude):
    """Let boom and dipper swing to and fro for good, the one fastest where the other turns."""
    first, (_, boom, dipper) = np.array(context.positions(0.0)), np.eye(len(context.arm()))[:3]
    turn = 2 * np.pi * 3.3
    context.positions = lambda t: (
        first + amplitude * (boom * np.sin(turn * t) + dipper * np.cos(turn * t))
    )
    context.velocities = lambda t: (
        amplitude * turn * (boom * np.cos(turn * t) - dipper * np.sin(turn * t))
    )


def test_an_arm_that_does_not_come_to_rest_is_a_failure_that_names_the_joint(stopping, fakes):
    shaking(stopping, 0.03)
    outcome = fakes.finish(PlanRetreat(PlanRetreatSettings(), stopping))
    assert not outcome.success
    assert re.fullmatch(
        r"J_(BOOM|DIPPER) still moves, by 0\.0(59|60) within the last second", outcome.reason
    )
    assert not stopping.plugins["motion"].starts
    assert stopping.time_s == pytest.approx(10.0, abs=2 * fakes.TICK_S)


def test_an_arm_that_shakes_on_the_spot_stands(stopping, fakes):
    shaking(stopping, 0.008)
    fakes.finish(PlanRetreat(PlanRetreatSettings(), stopping))
    assert stopping.plugins["motion"].starts
    assert 1.0 <= stopping.time_s < 2.0  # a window of a second, and the leaf's own steps


def test_a_joint_is_at_rest_below_its_speed_or_while_it_stays_where_it_is() -> None:
    slow, fast = np.array([0.0, 0.0099]), np.array([0.0, -0.0101])
    assert Rest().add(0.0, np.zeros(2), slow)
    assert not Rest().add(0.0, np.zeros(2), fast)
    least = 0.4 * START_TOLERANCE
    for step, is_at_rest in ((0.99 * least, True), (1.01 * least, False)):
        rest = Rest()
        answers = [rest.add(0.1 * k, np.array([0.0, step * (k % 2)]), fast) for k in range(14)]
        assert answers == [*[False] * 10, *[is_at_rest] * 4]
        assert rest.strayed() == pytest.approx([0.0, step])


def test_only_the_last_second_counts_for_a_joint_that_shakes() -> None:
    rest, fast = Rest(), np.array([1.0])
    for k in range(5):
        rest.add(0.1 * k, np.array([0.1 * k]), fast)  # on its way
    answers = [rest.add(0.1 * k, np.array([0.4]), fast) for k in range(5, 16)]
    assert answers == [*[False] * 9, True, True]
