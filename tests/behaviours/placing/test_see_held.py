"""SeeHeld, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.see_held import SeeHeld
from executive.events.stone import StoneSeenInJaws
from executive.geometry.pose import pose
from executive.interfaces.alignment import Aligner
from executive.interfaces.motion import MotionPlanner
from executive.leaf.surroundings import held_surface
from executive.messages.alignment import Alignment, Uncertainty
from executive.messages.command import SwitchLidars
from executive.messages.request import MotionPlan
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import NO_PATH, plugins


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
    low_m = world.hold.T_map_gripper[2, 3]

    def command(command):
        if isinstance(command, SwitchLidars):
            switched_m.append(context.gripper()[2, 3])

    context.gripper = lambda: pose(t=np.array([5.0, 0.0, low_m + 1.2 * min(context.time_s, 1.0)]))
    robot.answers(command=command)
    return switched_m


def test_a_stone_that_the_closing_jaws_moved_is_corrected_in_the_database(stage, world, database):
    before = database.stone(1).centroid_map
    seen_in_jaws(stage, world, pose(t=np.array([-0.05, 0.0, 0.0])))  # the view moves to the model
    seen = held_surface(world.leaf_context, world.hold)[:200] + [0.05, 0.0, 0.0]
    plugins(world)["mapping"].seen = seen
    low_m = world.hold.T_map_gripper[2, 3]
    switched_m = rises(world)
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS", ended.reason
    assert ended.outputs == {"hang_is_known": True}
    (asked,) = plugins(world)["motion"].calls("move")  # one motion, without a stop on the way
    assert asked["request"].T_map_gripper[2, 3] == pytest.approx(low_m + 0.7 + 0.5)
    assert switched_m[0] == pytest.approx(low_m + 0.7, abs=0.06)  # once it is clear of the ground
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


@pytest.mark.parametrize(
    ("yields", "hangs", "weight", "asked_kg"),
    [
        (True, True, Weight(1800.0, 50.0), 1900.0),
        (True, True, None, 2000.0),  # what the trial lift told, not what sways now
        (True, False, None, None),
        (False, True, Weight(1800.0, 50.0), None),
    ],
)
def test_the_raise_is_no_quicker_than_supports_that_yield_bear(
    stage, world, monkeypatch, yields, hangs, weight, asked_kg
):
    context = world.leaf_context
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6 if yields else None})
    monkeypatch.setattr(context, "machine", lambda: machine.model_copy(update={"stance": stance}))
    monkeypatch.setattr(context, "weight", lambda: weight)
    monkeypatch.setattr(context, "trial_weight", lambda: Weight(1760.0, 120.0))
    monkeypatch.setattr(context, "payload_kg", lambda: 1500.0)
    monkeypatch.setattr(context, "is_carried", lambda: hangs)
    seen_in_jaws(stage, world, np.eye(4))
    rises(world)
    world.tick(SeeHeld, hold=world.hold)
    (asked,) = plugins(world)["motion"].calls("move")
    assert asked["request"].held_kg == asked_kg


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
    told = [(one.accepted, one.shift_m, one.refused) for one in ended.events]
    assert told == [(False, None, ended.reason)]


def test_a_view_that_is_refused_keeps_the_expected_pose(stage, world, database):
    before = database.stone(1).T_map_object
    seen_in_jaws(stage, world, pose(t=np.array([-0.2, 0.0, 0.0])), accepted=False)
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.reason == "kept the expected pose of stone 1: rmse 5 cm above 4"
    assert ended.outputs == {"hang_is_known": False}
    np.testing.assert_array_equal(database.stone(1).T_map_object, before)
    told = [(one.accepted, one.shift_m, one.refused) for one in ended.events]
    assert told == [(False, None, "")]


def test_a_stone_that_cannot_be_raised_is_not_looked_at(world, database):
    plugins(world)["alignment"] = None
    ended = world.tick(SeeHeld, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "no path up: the boom would hit stone 2" in ended.reason
    assert ended.outputs == {"hang_is_known": False}
    assert ended.events == []
