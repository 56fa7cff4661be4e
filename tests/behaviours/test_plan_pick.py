"""A way to a grasp: the first that is free, and after a failure one unlike those before."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.plan_pick import PlanPick, PlanPickSettings
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.request import MotionPlan
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.trajectory import JointTrajectory

POINTS = np.random.default_rng(0).uniform(-0.4, 0.4, (50, 3)) + [5, 0, 0.4]


class Objects(SqliteObjects):
    """Keeps stones as they are given; scene verbs are the real ones."""

    def __init__(self):
        super().__init__(SqliteObjects.Settings())
        self.T_map_object = pose(t=np.array([5.0, 0.0, 0.4]))
        self.events = []

    def stone(self, stone_id):
        return Stone(
            stone_id, StoneState.ON_GROUND, POINTS, POINTS.mean(axis=0), self.T_map_object, True
        )

    def stones(self):
        return (self.stone(1),)

    def history(self, stone_id):
        return tuple(self.events)

    def now_is(self, state, stamp_s):
        self.events.append(StoneEvent(stamp_s, "state", state, self.T_map_object))


class Mapper:
    def cloud(self):
        return Cloud("map", POINTS)


class Planner:
    def __init__(self, blocked=(), reached=None):
        self.blocked, self.reached, self.asked = blocked, reached, []

    def reach(self, T_base_gripper, seed):
        return self.reached

    def move(self, request):
        self.asked.append(request)
        x = round(float(request.T_map_gripper[0, 3]), 3)
        if x in self.blocked:
            return MotionPlan(None, f"blocked at {x}", np.zeros((0, 3)))
        start = np.stack([request.start, request.start])
        names = tuple(f"j{i}" for i in range(len(request.start)))
        return MotionPlan(
            JointTrajectory(names, np.array([0.0, 1.0]), start, 0 * start), "", np.zeros((0, 3))
        )


def grasp(x, yaw=0.0, T_map_map=None):
    T = pose(from_rpy(0, np.pi / 2, yaw), np.array([x, 0.0, 1.5]))
    return Grasp(T if T_map_map is None else T_map_map @ T, 2.0, 1.0, {})


@pytest.fixture
def leaf(fakes):
    context = fakes.Context(objects=Objects(), mapping=Mapper(), motion=Planner())
    return PlanPick(PlanPickSettings(), context)


def test_takes_the_first_with_a_free_way_and_keeps_the_rest(leaf, fakes):
    leaf.context.plugins["motion"] = Planner(blocked=(5.0,))
    outcome = fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3), grasp(5.6)])
    assert outcome.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.3)
    assert [g.T_map_gripper[0, 3] for g in outcome.outputs.grasps] == [pytest.approx(5.6)]
    assert leaf.context.notes[0][1]["passed_over"] == ["blocked at 5.0"]


def test_no_free_way_is_a_failure_with_all_reasons(leaf, fakes):
    leaf.context.plugins["motion"] = Planner(blocked=(5.0, 5.3))
    outcome = fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    assert not outcome.success
    assert "blocked at 5.0; blocked at 5.3" in outcome.reason


def test_an_empty_list_says_why_the_grasps_before_were_refused(leaf, fakes):
    leaf.context.plugins["motion"] = Planner(blocked=(5.0,))
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0)])
    outcome = fakes.finish(leaf, stone=1, grasps=[])
    assert not outcome.success
    assert "no grasp of stone 1 is left: no path to any of 1: blocked at 5.0" in outcome.reason


def test_an_empty_list_after_an_attempt_does_not_blame_the_way(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0)])
    assert "those before were tried" in fakes.finish(leaf, stone=1, grasps=[]).reason


def test_the_second_attempt_is_unlike_the_first(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    again = fakes.finish(leaf, stone=1, grasps=[grasp(5.02), grasp(5.3)])
    assert again.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.3)


def test_the_same_grasp_with_exchanged_jaws_is_no_other_attempt(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    again = fakes.finish(leaf, stone=1, grasps=[grasp(5.02, yaw=np.pi), grasp(5.3)])
    assert again.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.3)


def test_likeness_is_judged_on_the_stone_wherever_it_lies_now(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    moved = pose(from_rpy(0, 0, 0.7), np.array([0.0, 1.0, 0.0]))
    leaf.context.plugins["objects"].T_map_object = (
        moved @ leaf.context.plugins["objects"].T_map_object
    )
    again = fakes.finish(
        leaf, stone=1, grasps=[grasp(5.0, T_map_map=moved), grasp(5.3, T_map_map=moved)]
    )
    np.testing.assert_allclose(
        again.outputs.grasp.T_map_gripper, grasp(5.3, T_map_map=moved).T_map_gripper
    )


def test_another_stone_is_a_new_story(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    other = fakes.finish(leaf, stone=2, grasps=[grasp(5.0), grasp(5.3)])
    assert other.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.0)


def test_a_grasp_that_worked_is_taken_again(leaf, fakes):
    fakes.finish(leaf, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    objects = leaf.context.plugins["objects"]
    objects.now_is(StoneState.PLACED, leaf.context.time_s + 30.0)
    objects.now_is(StoneState.ON_GROUND, leaf.context.time_s + 60.0)  # another round begins
    leaf.context.time_s += 60.0
    again = fakes.finish(leaf, limit_s=200.0, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    assert again.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.0)


def test_a_grasp_that_lost_the_stone_after_the_last_placement_is_not(leaf, fakes):
    objects = leaf.context.plugins["objects"]
    objects.now_is(StoneState.PLACED, leaf.context.time_s)
    leaf.context.time_s += 60.0
    fakes.finish(leaf, limit_s=200.0, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    again = fakes.finish(leaf, limit_s=200.0, stone=1, grasps=[grasp(5.0), grasp(5.3)])
    assert again.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.3)


@pytest.mark.parametrize("leans", [True, False])
def test_the_way_leads_to_where_the_grasp_is_once_the_machine_leans(leaf, fakes, leans):
    context = leaf.context
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6 if leans else None})
    context.machine = lambda: machine.model_copy(update={"stance": stance})
    side = context.arm().copy()
    side[machine.arm_names.index(machine.turn_joint)] += np.pi / 2
    planner = context.plugins["motion"] = Planner(reached=side)
    assert fakes.finish(leaf, stone=1, grasps=[grasp(5.0)]).success
    (asked,) = planner.asked
    off = np.abs(asked.T_map_base - context.state().T_map_base).max()
    assert (1e-3 < off < 0.02) if leans else off == 0.0


def test_a_grasp_out_of_reach_is_planned_from_where_the_machine_is(leaf, fakes):
    context = leaf.context
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6})
    context.machine = lambda: machine.model_copy(update={"stance": stance})
    planner = context.plugins["motion"] = Planner(reached=None)
    assert fakes.finish(leaf, stone=1, grasps=[grasp(5.0)]).success
    np.testing.assert_array_equal(planner.asked[0].T_map_base, context.state().T_map_base)


def holding(x, hold_rate):
    """A grasp of which lifts were rehearsed."""
    return replace(grasp(x), hold_rate=hold_rate)


def attempt(leaf, fakes, grasps):
    """The chance that an attempt was told to have; 0 s is before all that happens to the stone."""
    fakes.finish(leaf, stone=1, grasps=grasps)
    return leaf.context.notes[-1][1]["success"]


def test_an_attempt_tells_its_chance_and_learns_what_came_of_those_before(leaf, fakes):
    first = attempt(leaf, fakes, [holding(5.0, 0.9)])
    failed = attempt(leaf, fakes, [holding(5.3, 0.9)])
    assert 0.8 < first < 0.95
    assert failed < first - 0.04


def test_a_stone_that_was_placed_makes_the_next_attempt_likelier(leaf, fakes):
    first = attempt(leaf, fakes, [holding(5.0, 0.9)])
    leaf.context.plugins["objects"].now_is(StoneState.PLACED, leaf.context.now_s() + 0.1)
    assert attempt(leaf, fakes, [holding(5.3, 0.9)]) > first


def test_nothing_is_expected_of_a_grasp_that_nobody_lifted(leaf, fakes):
    assert attempt(leaf, fakes, [grasp(5.0)]) is None


def test_grasps_below_the_least_success_are_refused_with_their_chance(fakes):
    context = fakes.Context(objects=Objects(), mapping=Mapper(), motion=Planner())
    leaf = PlanPick(PlanPickSettings(least_success=0.8), context)
    outcome = fakes.finish(leaf, stone=1, grasps=[holding(5.0, 0.1), holding(5.3, 0.2)])
    assert not outcome.success
    assert "least_success asks for 80%" in outcome.reason
    assert not context.plugins["motion"].asked
    outcome = fakes.finish(leaf, stone=1, grasps=[holding(5.0, 0.1), holding(5.3, 0.95)])
    assert outcome.outputs.grasp.T_map_gripper[0, 3] == pytest.approx(5.3)
