"""Leaves that move the machine wait for it, notice when it is stuck, and stop it when they are
given up.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.close_gripper import CloseGripper, CloseGripperSettings
from executive.behaviours.execute_trajectory import ExecuteTrajectory, ExecuteTrajectorySettings
from executive.behaviours.open_gripper import OpenGripper, OpenGripperSettings
from executive.behaviours.scan_swing import ScanSwing, ScanSwingSettings
from executive.messages.cloud import Cloud
from executive.messages.command import Follow, LimitStop, MoveJaws, SwitchLidars
from executive.messages.request import MotionPlan
from executive.messages.stone import Stone, StoneState
from executive.messages.trajectory import JointTrajectory


class Robot:
    def __init__(self):
        self.commands = []
        self.stops = 0

    def command(self, command):
        self.commands.append(command)

    def stop(self):
        self.stops += 1


class Mapper:
    def __init__(self):
        self.removed = []
        self.added = []
        self.masks = []

    def cloud(self):
        return Cloud("map", np.zeros((5, 3)))

    def remove_sphere(self, centre, radius_m):
        self.removed.append((tuple(centre), radius_m))
        return 12

    def add_surface(self, points_map):
        self.added.append(points_map)

    def mask_held(self, radius_m):
        self.masks.append(radius_m)


def turn_by(context, angle, duration=2.0):
    start = context.arm()
    position = np.stack([start, start + [angle, *[0] * (len(start) - 1)]])
    return JointTrajectory(
        context.machine().arm_names, np.array([0.0, duration]), position, np.zeros_like(position)
    )


class Held:
    """An object database in which some stones are held."""

    def __init__(self, *states):
        self.states = states

    def stones(self):
        return tuple(SimpleNamespace(id=i, state=state) for i, state in enumerate(self.states))


def moving(context, trajectory, reaches=1.0):
    """Let the arm go a share of the way, linearly in time."""
    first, last = trajectory.position[0], trajectory.position[-1]
    context.positions = lambda t: first + (last - first) * min(t / trajectory.duration_s, reaches)


def test_ends_when_the_arm_has_arrived(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    moving(context, trajectory)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    outcome = fakes.finish(leaf, trajectory=trajectory)
    assert outcome.success
    assert context.time_s == pytest.approx(2.0, abs=2 * fakes.TICK_S)
    assert context.plugins["robot"].stops == 0


@pytest.mark.parametrize(
    ("yields", "payload_kg", "is_slow"),
    [(True, 1500.0, True), (True, 50.0, False), (True, None, False), (False, 1500.0, False)],
)
def test_a_stop_is_slower_with_a_load_on_supports_that_yield(fakes, yields, payload_kg, is_slow):
    """Where nothing hangs, or the chassis is fixed to the ground, only the joints limit it."""
    context = fakes.Context(robot=Robot(), objects=Held())
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6 if yields else None})
    context.machine = lambda: machine.model_copy(update={"stance": stance})
    context.payload = payload_kg
    trajectory = turn_by(context, 0.5)
    trajectory = replace(trajectory, velocity=np.full_like(trajectory.position, 0.25))
    moving(context, trajectory)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    assert fakes.finish(leaf, trajectory=trajectory).success
    (followed,) = context.plugins["robot"].commands
    assert (0.5 < followed.stop_s <= 2.5) if is_slow else followed.stop_s == 0.0


@pytest.mark.parametrize(("standing", "is_told"), [(1.0, True), (0.5, False), (None, False)])
def test_an_arm_whose_load_has_met_the_ground_stops_no_slower_than_unloaded(
    fakes, standing, is_told
):
    """It presses on what it has set down for as long as a load in the air would ask for."""
    context = fakes.Context(robot=Robot(), objects=Held())
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6})
    context.machine = lambda: machine.model_copy(update={"stance": stance})
    context.payload, context.on_ground = 1500.0, standing
    trajectory = turn_by(context, 0.5)
    trajectory = replace(trajectory, velocity=np.full_like(trajectory.position, 0.25))
    moving(context, trajectory)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    steps = leaf.run(trajectory=trajectory)
    next(steps)
    steps.close()
    follow, *others = context.plugins["robot"].commands
    assert follow.stop_s > 0.5
    assert [one.stop_s for one in others] == ([0.0] if is_told else [])
    assert context.plugins["robot"].stops == 1


def test_an_arm_that_is_stuck_is_noticed_and_stopped(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    moving(context, trajectory, reaches=0.7)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    outcome = fakes.finish(leaf, trajectory=trajectory)
    assert not outcome.success
    assert "J_TURN is 0.150 off its goal" in outcome.reason
    assert context.plugins["robot"].stops == 1


@pytest.mark.parametrize(
    ("state", "stops"), [(StoneState.ON_GROUND, True), (StoneState.HELD, False)]
)
def test_an_arm_that_holds_no_stone_stops_for_what_it_meets(fakes, state, stops):
    """A held stone hangs, and presses as it is set down: others watch that."""
    context = fakes.Context(robot=Robot(), objects=Held(state))
    trajectory = turn_by(context, 0.5)
    moving(context, trajectory)
    pressed = iter([0.0] * 10)
    context.payload_kg = lambda: next(pressed, -9000.0)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    outcome = fakes.finish(leaf, trajectory=trajectory)
    assert outcome.success is not stops
    assert context.plugins["robot"].stops == int(stops)
    if stops:
        assert outcome.reason.startswith("the arm presses on something")


@pytest.mark.parametrize("yields", [True, False])
def test_what_an_empty_gripper_lifts_is_lowered_along_the_same_path(fakes, yields):
    """It stops as slowly as what hangs asks for, and goes back to where it began."""
    robot = Robot()
    context = fakes.Context(robot=robot, objects=Held())
    machine = context.machine()
    stance = machine.stance.model_copy(update={"support_n_m": 2e6 if yields else None})
    context.machine = lambda: machine.model_copy(update={"stance": stance})
    names, start = machine.arm_names, context.arm()
    boom = names.index("J_BOOM")
    position = np.tile(start, (5, 1))
    position[:, boom] += [0.0, -0.01, -0.03, -0.05, -0.06]
    raised = JointTrajectory(names, np.arange(5) / 4, position, np.zeros_like(position))

    def arm(time_s):
        """At 0.7 of the way it stops; then it follows its way back."""
        follows = [one for one in robot.commands if isinstance(one, Follow)]
        if len(follows) > 1:
            began_s.append(time_s)
            return follows[-1].trajectory.at(time_s - began_s[0])[0]
        return raised.at(min(time_s, 0.7))[0]

    began_s = []
    context.positions = arm
    speeds = np.where(np.arange(len(names)) == boom, -0.1, 0.0)
    context.velocities = lambda time_s: speeds * (time_s < 0.7)
    context.payload_kg = lambda: 4000.0 if context.time_s >= 0.5 and not began_s else 0.0
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    outcome = fakes.finish(leaf, trajectory=raised)
    assert not outcome.success
    assert outcome.reason.startswith("something hangs on the jaws")
    _, limit, back = robot.commands
    assert isinstance(limit, LimitStop)
    assert (limit.stop_s > 0.0) is yields
    np.testing.assert_allclose(back.trajectory.position[0], raised.at(0.7)[0])
    np.testing.assert_allclose(back.trajectory.position[-1], start)
    heights = -back.trajectory.position[:, boom]
    assert (np.diff(heights) <= 1e-9).all()  # the same way, without a turn
    assert np.diff(heights).min() > -0.01


def test_a_motion_with_a_scan_has_the_lidars_on_until_its_end(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    moving(context, trajectory)
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(scan=True), context)
    assert fakes.finish(leaf, trajectory=trajectory).success
    on, follow, off = context.plugins["robot"].commands
    assert (on.on, off.on) == (True, False)
    assert follow.trajectory is trajectory


def test_a_motion_with_a_scan_that_is_given_up_leaves_the_lidars_off(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(scan=True), context)
    steps = leaf.run(trajectory=turn_by(context, 0.5))
    next(steps)
    steps.close()
    switches = [c.on for c in context.plugins["robot"].commands if isinstance(c, SwitchLidars)]
    assert (switches, context.plugins["robot"].stops) == ([True, False], 1)


def test_a_motion_that_was_cut_off_goes_on_from_where_the_arm_is(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    half = trajectory.at(trajectory.duration_s / 2)[0]
    context.positions = lambda t: half
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    steps = leaf.verify(trajectory=trajectory)
    for _ in range(40):
        next(steps)
        context.time_s += fakes.TICK_S
        if context.plugins["robot"].commands:
            break
    steps.close()
    (follow,) = context.plugins["robot"].commands
    np.testing.assert_allclose(follow.trajectory.position[0], half)
    np.testing.assert_allclose(follow.trajectory.position[-1], trajectory.position[-1])
    away = half + 0.1
    context.positions = lambda t: away
    steps = leaf.verify(trajectory=trajectory)
    outcome = fakes.finish(SimpleNamespace(context=context, run=lambda: steps))
    assert not outcome.success
    assert outcome.reason == "the arm left its path when the run was cut off: plan again"
    context.positions = lambda t: half + 0.2 * t
    context.velocities = lambda t: np.full(len(half), 0.2)
    steps = leaf.verify(trajectory=trajectory)
    outcome = fakes.finish(SimpleNamespace(context=context, run=lambda: steps))
    assert not outcome.success
    assert "still moves" in outcome.reason


def test_given_up_it_stops_the_machine(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    steps = ExecuteTrajectory(ExecuteTrajectorySettings(), context).run(trajectory=trajectory)
    next(steps)
    steps.close()
    assert isinstance(context.plugins["robot"].commands[0], Follow)
    assert context.plugins["robot"].stops == 1


def test_an_arm_that_was_pushed_since_the_plan_does_not_move(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    trajectory = turn_by(context, 0.5)
    pushed = trajectory.position[0] + [0.06, *[0] * (trajectory.position.shape[1] - 1)]
    context.positions = lambda t: pushed
    leaf = ExecuteTrajectory(ExecuteTrajectorySettings(), context)
    outcome = fakes.finish(leaf, trajectory=trajectory)
    assert not outcome.success
    assert "J_TURN has moved 0.060 since the path was planned" in outcome.reason
    assert not context.plugins["robot"].commands


class Planner:
    def __init__(self, context=None, reason=""):
        self.context, self.reason = context, reason

    def swing(self, start, angle_rad, duration_s, around=None):
        trajectory = None if self.reason else turn_by(self.context, 0.0, duration_s)
        return MotionPlan(trajectory, self.reason, np.zeros((0, 3)))


def test_a_scan_switches_the_lidars_on_and_off_again(fakes):
    context = fakes.Context(robot=Robot(), mapping=Mapper())
    context.plugins["motion"] = Planner(context)
    outcome = fakes.finish(ScanSwing(ScanSwingSettings(duration=3.0), context))
    switches = [c.on for c in context.plugins["robot"].commands if isinstance(c, SwitchLidars)]
    assert outcome.success
    assert switches == [True, False]
    assert context.notes == [("site_scanned", {"points": 5})]


def test_a_scan_that_is_given_up_leaves_the_lidars_off(fakes):
    context = fakes.Context(robot=Robot(), mapping=Mapper())
    context.plugins["motion"] = Planner(context)
    steps = ScanSwing(ScanSwingSettings(), context).run()
    job = steps.send(None)
    while job is not None:  # until the arm is driven
        job = steps.send(job.result())
    steps.close()
    assert [c.on for c in context.plugins["robot"].commands if isinstance(c, SwitchLidars)] == [
        True,
        False,
    ]


def test_no_swing_is_a_failure_with_its_reason(fakes):
    context = fakes.Context(
        robot=Robot(), mapping=Mapper(), motion=Planner(reason="boom beyond its range")
    )
    outcome = fakes.finish(ScanSwing(ScanSwingSettings(), context))
    assert (outcome.success, outcome.reason) == (False, "no swing: boom beyond its range")
    assert context.plugins["robot"].commands == []


def test_jaws_that_do_not_open_are_a_failure(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    context.jaw = lambda t: 0.4
    assert not fakes.finish(OpenGripper(OpenGripperSettings(), context)).success


def test_jaws_that_open_are_a_success(fakes):
    context = fakes.Context(robot=Robot(), objects=Held())
    full = context.machine().gripper.open_rad
    context.jaw = lambda t: min(0.3 + 0.4 * t, full)
    assert fakes.finish(OpenGripper(OpenGripperSettings(), context)).success
    assert context.time_s > (full - 0.3) / 0.4


class Objects(SqliteObjects):
    """Keeps stones as they are given; scene verbs are the real ones."""

    def __init__(self, stone, others=()):
        super().__init__(SqliteObjects.Settings())
        self.calls = []
        self._stone = stone
        self._others = others

    def stones(self):
        return (self._stone, *self._others)

    def stone(self, stone_id):
        return replace(self._stone, state=StoneState.ON_GROUND)

    def grasp(self, stone_id, T_map_gripper, stamp_s):
        self.calls.append(("grasp", stone_id))
        return self._stone


STONE = Stone(
    3, StoneState.HELD, np.array([[5.0, 0, 0], [5.0, 0, 1]]), np.array([5, 0, 0.5]), np.eye(4), True
)


def test_closing_on_a_stone_tells_database_map_and_monitors(fakes):
    context = fakes.Context(robot=Robot(), objects=Objects(STONE), mapping=Mapper(), monitoring=())
    context.jaw = lambda t: max(0.9 - 0.4 * t, 0.35)
    outcome = fakes.finish(CloseGripper(CloseGripperSettings(), context), stone=3)
    assert outcome.success
    assert (outcome.outputs.hold.stone_id, outcome.outputs.hold.jaw_rad) == (3, 0.35)
    assert context.plugins["objects"].calls == [("grasp", 3)]
    assert context.plugins["mapping"].removed == [((5, 0, 0.5), 1.0)]
    assert context.plugins["mapping"].masks == [pytest.approx(0.6)]
    assert context.holds == ["begin"]
    assert isinstance(context.plugins["robot"].commands[0], MoveJaws)


def test_the_map_forgets_the_whole_of_a_long_stone(fakes):
    long_stone = Stone(
        3,
        StoneState.HELD,
        np.array([[5.0, 0, -1.3], [5.0, 0, 1.3]]),
        np.array([5, 0, 0]),
        np.eye(4),
        True,
    )
    context = fakes.Context(
        robot=Robot(), objects=Objects(long_stone), mapping=Mapper(), monitoring=()
    )
    context.jaw = lambda t: max(0.9 - 0.4 * t, 0.35)
    fakes.finish(CloseGripper(CloseGripperSettings(), context), stone=3)
    assert context.plugins["mapping"].removed == [((5, 0, 0), pytest.approx(1.4))]


def test_what_the_map_forgets_of_other_stones_is_put_back(fakes):
    def other(stone_id, state, *points):
        return Stone(stone_id, state, np.array(points), np.mean(points, axis=0), np.eye(4), True)

    beside = other(4, StoneState.PLACED, [5.9, 0, 0.5], [6.1, 0, 0.5])  # 0.9 and 1.1 m away
    lost = other(5, StoneState.LOST, [5.0, 0.5, 0.5])
    context = fakes.Context(
        robot=Robot(), objects=Objects(STONE, [beside, lost]), mapping=Mapper(), monitoring=()
    )
    context.jaw = lambda t: max(0.9 - 0.4 * t, 0.35)
    fakes.finish(CloseGripper(CloseGripperSettings(), context), stone=3)
    (added,) = context.plugins["mapping"].added
    np.testing.assert_array_equal(added, [[5.9, 0, 0.5]])
    assert dict(context.notes)["stone_grasped"]["put_back_points"] == 1


def test_closing_on_nothing_is_a_failure_that_holds_nothing(fakes):
    context = fakes.Context(robot=Robot(), objects=Objects(STONE), mapping=Mapper(), monitoring=())
    context.jaw = lambda t: max(0.9 - 0.4 * t, 0.01)
    outcome = fakes.finish(CloseGripper(CloseGripperSettings(), context), stone=3)
    assert not outcome.success
    assert context.notes[0][0] == "jaws_closed_on_nothing"
    assert context.plugins["objects"].calls == []
    assert context.holds == []
