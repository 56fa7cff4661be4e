"""TrialLift, ticked to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.trial_lift import TrialLift
from executive.events.stone import StoneNotLifted
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.leaf.tool_way import tool_way
from executive.machine.sway import Sway
from executive.messages.command import Follow
from executive.messages.request import MotionPlan
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import NO_PATH, plugins


def planned(stage, world, off_rad=0.0, risen_m=0.0, rises=1.0):
    """Let the planner answer a path that ends off the place where the arm stays.

    The gripper is above the grasp by a height, and by a share of each lift that is asked for, the
    last share for all further ones.
    """
    shares = [rises] if isinstance(rises, float) else list(rises)

    def gripper():
        T = world.hold.T_map_gripper @ pose()
        asked = [one["request"].leave_m for one in plugins(world)["motion"].calls("move")]
        risen = [way_m * shares[min(i, len(shares) - 1)] for i, way_m in enumerate(asked)]
        T[2, 3] += risen_m + sum(risen)
        return T

    world.leaf_context.gripper = gripper
    names = world.leaf_context.machine().arm_names
    stay = np.stack([world.leaf_context.arm()] * 2)
    stay[1] += off_rad
    path = JointTrajectory(names, np.array([0.0, 1.0]), stay, np.zeros_like(stay))
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=MotionPlan(path, "", NO_PATH))


def held_kg(world, database):
    """Return the mass of the held stone by its volume [kg]."""
    return database.stone(world.hold.stone_id).mass_kg


@pytest.mark.parametrize(
    ("share", "status"), [(0.95, "SUCCESS"), (0.72, "SUCCESS"), (0.6, "FAILURE")]
)
def test_a_stone_of_which_the_ground_carries_a_part_is_not_lifted(
    stage, world, database, share, status
):
    planned(stage, world, risen_m=0.05, rises=0.0)
    whole_kg = held_kg(world, database)
    world.leaf_context.payload = share * whole_kg
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == status
    # The monitors take a stone for settled only if it hangs.
    assert ("carry" in world.leaf_context.holds) == (status == "SUCCESS")
    assert len(world.leaf_context.below) == (status == "SUCCESS")
    told = [one for one in world.leaf_context.events if isinstance(one, StoneNotLifted)]
    if status == "SUCCESS":
        assert ended.reason == f"it hangs 0.05 m up with {share * whole_kg:.0f} ± 0 kg"
        assert told == []
        return
    assert "the ground still carries a part of stone 1" in ended.reason
    assert ended.reason.endswith("(by its volume; light stones need less `borne`)")
    (event,) = told
    assert event.hanging_kg == pytest.approx(share * whole_kg)
    assert event.least_kg == pytest.approx(whole_kg)
    assert event.higher_kg is None
    assert event.up_m == pytest.approx(0.05)


def test_jaws_that_are_pushed_up_by_a_standing_stone_are_told(stage, world):
    """They close on faces that widen downwards, and slide up on them."""
    planned(stage, world, risen_m=0.2)
    world.leaf_context.payload = -4100.0
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    told = "stone 1 stands on the ground, and the jaws that close on it are pushed up by the"
    assert ended.reason.startswith(told)
    assert ended.reason.endswith("(by its volume; light stones need less `borne`)")


@pytest.mark.parametrize(
    ("known_kg", "status"), [(900.0, "SUCCESS"), (955.0, "SUCCESS"), (958.0, "FAILURE")]
)
def test_a_stone_that_was_weighed_before_has_to_weigh_as_much(
    stage, world, database, known_kg, status
):
    planned(stage, world)
    database.weigh(1, Weight(known_kg, 20.0), 1.0)
    world.leaf_context.payload = 900.0
    assert world.tick(TrialLift, hold=world.hold).status == status


@pytest.mark.parametrize(("hangs_kg", "status"), [(1240.0, "SUCCESS"), (1260.0, "FAILURE")])
def test_jaws_that_hold_more_than_the_stone_was_weighed_at_hold_another_one(
    stage, world, database, hangs_kg, status
):
    planned(stage, world, risen_m=0.2)
    database.weigh(1, Weight(1000.0, 20.0), 1.0)
    world.leaf_context.payload = hangs_kg
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == status
    told = [one for one in world.leaf_context.events if isinstance(one, StoneNotLifted)]
    assert [one.most_kg for one in told] == ([] if status == "SUCCESS" else [1250.0])
    assert ("another one hangs with it" in ended.reason) == (status == "FAILURE")
    assert ("carry" in world.leaf_context.holds) == (status == "SUCCESS")


@pytest.mark.parametrize(
    ("weighed", "share", "lifts"),
    [
        ([], 0.99, 2),
        ([], 1.0, 1),
        ([0.96], 0.87, 1),  # one stone tells the level, and little of the spread
        ([0.96], 0.85, 2),
        ([0.96] * 6, 0.91, 1),
        ([0.96] * 6, 0.89, 2),
        ([0.84, 0.78, 0.9], 0.77, 1),  # natural stones fill their hulls by less
        ([0.84, 0.78, 0.9], 0.74, 2),
        ([1.3] * 6, 0.95, 1),
    ],
)
def test_stones_that_were_placed_tell_which_others_are_weighed_once_more(
    stage, world, database, weighed, share, lifts
):
    """A view from one side has too small a volume: its stone seems heavy, and tells nothing."""
    planned(stage, world)
    one, other = database.stone(1), database.stone(2)
    placed = [
        replace(other, state=StoneState.PLACED, weight=Weight(x * other.mass_by_volume_kg, 5.0))
        for x in weighed
    ]
    database.stones = lambda: (one, *placed)
    world.leaf_context.payload = share * held_kg(world, database)
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    assert len(plugins(world)["motion"].calls("move")) == lifts


def weighed_at(world, database, shares):
    """Let the share of its mass by volume that hangs in the jaws depend on the lift."""
    whole_kg, motion = held_kg(world, database), plugins(world)["motion"]

    def payload_kg():
        return shares[len(motion.calls("move")) - 1] * whole_kg

    world.leaf_context.payload_kg = payload_kg


@pytest.mark.parametrize(
    ("shares", "lifts", "status"),
    [
        ([1.0], 1, "SUCCESS"),
        ([0.8, 0.8], 2, "SUCCESS"),  # the first stone of a site is weighed at two heights
        ([0.8, 0.83], 2, "SUCCESS"),
        ([0.8, 0.75], 2, "FAILURE"),  # an edge still stands, and the stone tilts about it
        ([0.8, 1.0], 2, "FAILURE"),
        ([0.6, 0.6], 1, "FAILURE"),  # lighter than any rock
    ],
)
def test_a_light_stone_hangs_free_if_it_weighs_the_same_higher_up(
    stage, world, database, shares, lifts, status
):
    planned(stage, world)
    weighed_at(world, database, shares)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == status
    asked = [one["request"].leave_m for one in plugins(world)["motion"].calls("move")]
    assert asked == pytest.approx([0.2, 0.1][:lifts])
    told = [one for one in world.leaf_context.events if isinstance(one, StoneNotLifted)]
    if status == "SUCCESS":
        assert told == []
    elif lifts == 2:
        assert ended.reason.endswith("as it was raised on: what hangs free weighs the same")
        assert told[0].higher_kg == pytest.approx(shares[1] * held_kg(world, database))


def test_a_light_stone_whose_weight_is_noise_is_not_taken_to_hang_free(stage, world, database):
    """Two weights that nobody knows to a tenth are not known to be equal."""
    planned(stage, world)
    rng, whole_kg = np.random.default_rng(3), held_kg(world, database)
    world.leaf_context.payload_kg = lambda: whole_kg * (0.85 + 0.3 * rng.normal())
    assert world.tick(TrialLift, hold=world.hold).status == "FAILURE"


def test_a_light_stone_that_cannot_be_raised_on_is_not_taken_to_hang_free(stage, world, database):
    planned(stage, world)
    move, weighed = plugins(world)["motion"].move, []

    def once(request):
        weighed.append(request)
        return move(request) if len(weighed) == 1 else MotionPlan(None, "out of reach", NO_PATH)

    plugins(world)["motion"].move = once
    world.leaf_context.payload = 0.8 * held_kg(world, database)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    assert ended.reason.endswith("it could not be raised on to be weighed once more")


def test_a_stone_that_was_weighed_is_not_raised_on(stage, world, database):
    planned(stage, world)
    database.weigh(1, Weight(held_kg(world, database), 20.0), 1.0)
    world.leaf_context.payload = 0.8 * held_kg(world, database)
    assert world.tick(TrialLift, hold=world.hold).status == "FAILURE"
    assert len(plugins(world)["motion"].calls("move")) == 1


def test_light_stones_may_hang_with_less_of_their_volume(stage, world, database):
    planned(stage, world)
    world.leaf_context.payload = 0.6 * held_kg(world, database)
    ended = world.tick(TrialLift, settings={"borne": 0.5}, hold=world.hold)
    assert ended.status == "SUCCESS"


def test_it_lifts_by_a_little_from_the_grasp_and_waits(stage, world):
    planned(stage, world)
    began_s = world.leaf_context.time_s
    ended = world.tick(TrialLift, settings={"height": 0.1, "wait": 2.0}, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.reason.endswith("no monitor weighs it")
    (asked,) = plugins(world)["motion"].calls("move")
    goal = asked["request"].T_map_gripper
    assert goal[2, 3] == pytest.approx(world.hold.T_map_gripper[2, 3] + 0.1)
    assert goal[:2, 3] == pytest.approx(world.hold.T_map_gripper[:2, 3])
    assert asked["request"].leave_m == pytest.approx(0.1)  # straight up
    assert world.leaf_context.time_s - began_s > 3.0  # the motion, and the wait


def test_a_grip_that_was_raised_meanwhile_is_lifted_by_the_rest_alone(stage, world):
    planned(stage, world, risen_m=0.08)
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    (asked,) = plugins(world)["motion"].calls("move")
    assert asked["request"].leave_m == pytest.approx(0.2 - 0.08)


@pytest.mark.parametrize(
    ("rises", "lifts"), [([1.0], 1), ([0.8], 1), ([0.4, 0.9], 2), ([0.0, 0.5, 1.0], 3), ([0.0], 3)]
)
def test_a_machine_that_sinks_under_the_load_lifts_on_up_to_three_times(stage, world, rises, lifts):
    planned(stage, world, rises=rises)
    machine = world.leaf_context.machine()
    on_legs = machine.stance.model_copy(update={"is_free": True})
    world.leaf_context.machine = lambda: machine.model_copy(update={"stance": on_legs})
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    asked = [one["request"].leave_m for one in plugins(world)["motion"].calls("move")]
    assert len(asked) == lifts
    if lifts == 2:
        np.testing.assert_allclose(asked, [0.2, 0.2 * (1 - 0.4)])


def test_a_load_that_would_tip_the_machine_is_not_lifted(stage, world):
    """The arm stops on its way, nothing is raised again, and no carry begins.

    What hangs is lowered to where it stood before the jaws open: let go, it would swing the
    machine.
    """
    planned(stage, world)
    context, before = world.leaf_context, world.leaf_context.arm()

    def lifting(time_s):
        """The arm is on its way up, until it is commanded anything but the first motion."""
        commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
        follows = [one for one in commands if isinstance(one, Follow)]
        return before + 0.02 * (len(follows) == 1)

    context.positions = lifting
    machine = world.leaf_context.machine()
    on_legs = machine.stance.model_copy(update={"is_free": True})
    world.leaf_context.machine = lambda: machine.model_copy(update={"stance": on_legs})
    world.leaf_context.payload = 9000.0
    ended = world.tick(TrialLift, hold=world.hold)
    assert (ended.status, "tip the machine here" in ended.reason) == ("FAILURE", True)
    assert len(plugins(world)["motion"].calls("move")) == 1
    assert len(plugins(world)["robot"].calls("stop")) == 1
    commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
    _, back = (one.trajectory for one in commands if isinstance(one, Follow))
    np.testing.assert_allclose(back.position[0], before + 0.02)
    np.testing.assert_allclose(back.position[-1], before)
    speed_m_s = np.diff(tool_way(machine, back)) / np.diff(back.times_s)
    assert 0.03 < speed_m_s.max() < 0.06
    assert "carry" not in world.leaf_context.holds
    (told,) = (one for one in world.leaf_context.events if isinstance(one, StoneNotLifted))
    assert told.hanging_kg == pytest.approx(9000.0)
    assert 0.0 < told.tipping_kg < 9000.0 / 0.9


def test_a_load_that_would_tip_the_machine_and_cannot_be_lowered_is_told_to_hang(stage, world):
    planned(stage, world)
    machine = world.leaf_context.machine()
    on_legs = machine.stance.model_copy(update={"is_free": True})
    world.leaf_context.machine = lambda: machine.model_copy(update={"stance": on_legs})
    world.leaf_context.payload = 9000.0
    before = world.leaf_context.arm()

    def pushed(time_s):
        """Where the arm is lifted to, and then farther than the path back begins."""
        commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
        return before + 0.05 * sum(isinstance(one, Follow) for one in commands)

    world.leaf_context.positions = pushed
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    assert "tip the machine here; it still hangs: " in ended.reason


@pytest.mark.parametrize(
    ("share", "is_seen_whole", "is_taken_on"),
    [(0.1, True, False), (1.0, True, True), (0.1, False, True)],
)
def test_a_heavy_load_is_taken_on_before_it_is_lifted(
    stage, world, database, share, is_seen_whole, is_taken_on
):
    """A light one is lifted at once, by the way and by what the machine sinks by.

    Nobody knows what a stone weighs that was seen from one side alone.
    """
    machine = world.leaf_context.machine()
    sideways = machine.posture("carry")
    sideways[machine.arm_names.index(machine.turn_joint)] = np.pi / 2
    world.leaf_context.positions = lambda time_s: sideways
    planned(stage, world, rises=[0.0, 1.0] if is_taken_on else [0.95])
    on_legs = machine.stance.model_copy(update={"is_free": True, "support_n_m": 2e6})
    machine = machine.model_copy(update={"stance": on_legs})
    world.leaf_context.machine = lambda: machine
    kg, motion = share * 2500.0, plugins(world)["motion"]
    if is_seen_whole:
        database.weigh(1, Weight(kg, 20.0), 1.0)
    stone = database.stone(1)
    assert not stone.seen_from_above
    world.leaf_context.payload_kg = lambda: stone.mass_kg if motion.calls("move") else 0.0
    sunk_m = Sway(machine).sink_m(world.leaf_context.arm(), stone.mass_kg)
    assert 0.0 < sunk_m < 0.1
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    asked = [one["request"].leave_m for one in plugins(world)["motion"].calls("move")]
    np.testing.assert_allclose(asked, [sunk_m, 0.2] if is_taken_on else [0.2 + sunk_m])


def test_a_load_that_hangs_already_is_not_taken_on_again(stage, world, database):
    machine = world.leaf_context.machine()
    on_legs = machine.stance.model_copy(update={"is_free": True, "support_n_m": 2e6})
    world.leaf_context.machine = lambda: machine.model_copy(update={"stance": on_legs})
    planned(stage, world)
    database.weigh(1, Weight(2500.0, 20.0), 1.0)
    world.leaf_context.payload = 2600.0
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    (asked,) = plugins(world)["motion"].calls("move")
    assert asked["request"].leave_m == 0.2


def test_a_machine_that_its_jaws_have_pushed_up_sinks_by_that_too(stage, world, database):
    machine = world.leaf_context.machine()
    on_legs = machine.stance.model_copy(update={"is_free": True, "support_n_m": 2e6})
    machine = machine.model_copy(update={"stance": on_legs})
    world.leaf_context.machine = lambda: machine
    planned(stage, world)
    database.weigh(1, Weight(1000.0, 20.0), 1.0)
    motion, sway, q = plugins(world)["motion"], Sway(machine), world.leaf_context.arm()
    world.leaf_context.payload_kg = lambda: 1000.0 if motion.calls("move") else -4000.0
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    asked = plugins(world)["motion"].calls("move")[0]["request"].leave_m
    pushed_m = -sway.sink_m(q, -4000.0)
    assert pushed_m > 2 * sway.sink_m(q, 1000.0)
    assert asked == pytest.approx(0.2 + sway.sink_m(q, 1000.0) + pushed_m)


def swaying(world, level_kg, amplitude, phase, period_s=1.0):
    """Let the jaws feel a mass that sways by a share of it, beginning at a place of the swing."""
    context, rng = world.leaf_context, np.random.default_rng(1)
    began_s = []

    def payload_kg():
        began_s[:] = began_s or [context.time_s]
        turn = 2 * np.pi * (context.time_s - began_s[0]) / period_s + phase
        return level_kg * (1 + amplitude * np.cos(turn)) + 0.01 * level_kg * rng.normal()

    context.payload_kg = payload_kg
    return lambda: context.time_s - began_s[0]


@pytest.mark.parametrize(
    ("share", "phase", "status"),
    [
        (0.75, 0.6 * np.pi, "SUCCESS"),  # the first 0.4 s are the trough of a swing
        (0.6, -0.4 * np.pi, "FAILURE"),  # and its crest
    ],
)
def test_a_stone_that_sways_is_judged_by_the_level_of_its_sway(
    stage, world, database, share, phase, status
):
    """A mean of 0.4 s would say 0.6 and 0.72 of the whole, on the other side of 0.67."""
    planned(stage, world)
    weighed_s = swaying(world, share * held_kg(world, database), 0.25, phase)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == status
    assert 0.4 < weighed_s() < 3 * 2.5


def test_a_sway_that_leaves_the_mass_open_is_weighed_for_no_longer_than_two_swings(
    stage, world, database
):
    """Noise of a third of the mass never tells on which side of the whole it is, nor how much."""
    planned(stage, world)
    rng, whole_kg = np.random.default_rng(2), held_kg(world, database)
    weighed_s = []

    def payload_kg():
        weighed_s.append(world.leaf_context.time_s)
        return whole_kg * (0.6 + 0.3 * rng.normal())

    world.leaf_context.payload_kg = payload_kg
    ended = world.tick(TrialLift, hold=world.hold)
    assert 2.5 < weighed_s[-1] - weighed_s[0] < 5.2
    assert " ± " in ended.reason


def test_a_machine_that_cannot_sink_lifts_once(stage, world):
    planned(stage, world, rises=0.4)
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    assert len(plugins(world)["motion"].calls("move")) == 1


def test_an_arm_that_is_held_back_does_not_lift_on(stage, world):
    planned(stage, world, off_rad=0.05, rises=0.0)
    assert world.tick(TrialLift, hold=world.hold).status == "FAILURE"
    assert len(plugins(world)["motion"].calls("move")) == 1


def test_a_stone_that_hangs_higher_already_is_not_lowered(stage, world):
    planned(stage, world, risen_m=0.5)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.reason == "it hangs 0.50 m up, and no monitor weighs it"
    assert plugins(world)["motion"].calls("move") == []


def test_without_a_path_up_nothing_is_tried_and_that_is_told(stage, world):
    planned(stage, world)
    none = stage.Scripted(MotionPlanner, move=MotionPlan(None, "out of reach", NO_PATH))
    plugins(world)["motion"] = none
    ended = world.tick(TrialLift, hold=world.hold)
    assert (ended.status, ended.reason) == ("SUCCESS", "not tried, no path up: out of reach")
    commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
    assert not any(isinstance(one, Follow) for one in commands)


def test_an_arm_that_does_not_get_up_is_a_failure(stage, world):
    planned(stage, world, off_rad=0.05)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    assert "off its goal" in ended.reason


@pytest.mark.parametrize(("share", "told"), [(-0.8, "stands on the ground"), (1, "off its goal")])
def test_an_arm_that_is_held_back_by_a_stone_on_the_ground_is_told_as_that(
    stage, world, database, share, told
):
    """Jaws that slide up on a stone that widens downwards press it down: they carry less than 0."""
    planned(stage, world, off_rad=0.05)
    world.leaf_context.payload = share * held_kg(world, database)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    assert told in ended.reason
    assert "carry" not in world.leaf_context.holds
