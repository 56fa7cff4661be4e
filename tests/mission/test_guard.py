"""The guard of a mission: what it refuses, what it counts, and what it tells once."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.events.watch import ObservationRefused, ScansNotFused
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.command import Drive, Follow
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from executive.mission.guard import MOST_BEHIND, Guard, GuardSettings, failure_of
from executive.mission.record.samples import Samples
from executive.watch.rules import TRACKING, EstimateRule, Rule
from executive.watch.watch import Decision, Wish

MACHINE = load_machine("m545")
IMU = next(name for name, sensor in MACHINE.sensors.items() if sensor.kind == "imu")
AGE_S = max(sensor.age_limit_s for sensor in MACHINE.sensors_of("imu"))
TICK_S = 0.05


class Robot:
    is_ideal = False
    lacks = frozenset({"lidar", "imu", "gnss", "encoders"})

    def __init__(self):
        self.given, self.stops = [], 0

    def command(self, command):
        self.given.append(command)

    def stop(self):
        self.stops += 1


class Streams:
    joints = None

    def __init__(self, state):
        self.newest = state

    def state(self):
        return self.newest

    def status_reason(self, status):
        return f"why it is {status}"

    def recent_states(self):
        return (self.newest,)


def state(stamp_s=0.0, status="GLOBAL"):
    still = {"v_map_cabin": np.zeros(3), "w_map_cabin_in_cabin": np.zeros(3)}
    poses = dict.fromkeys(("T_odom_base", "T_map_base", "T_map_cabin"), np.eye(4))
    covariance = 1e-6 * np.eye(6)
    return BaseState(stamp_s=stamp_s, covariance=covariance, status=status, **poses, **still)


class Watched:
    """A guard, its clock and robot, and what it records."""

    def __init__(self, one=None, **settings):
        self.clock, self.robot, self.events = SimulatedClock(), Robot(), []
        plugins = {"robot": self.robot, "estimation": SimpleNamespace(datum=None)}
        settings = GuardSettings(**settings)
        self.guard = Guard(settings, MACHINE, plugins, self.clock, self.events.append)
        self.streams = Streams(one or state())
        self.guard.bind(self.streams)

    def at(self, time_s):
        while self.clock.machine_s() < time_s - 1e-9:
            self.clock.advance(TICK_S)
        return self.guard


def sample(stamp_s, value=0.0):
    force = np.array([0.0, 0.0, 9.81])
    return ImuSample(stamp_s, IMU, np.array([0.0, 0.0, value]), force)


def test_an_observation_that_can_be_true_is_taken():
    watched = Watched()
    assert not watched.at(0.0).refuses(sample(0.0))
    assert not watched.guard.refused
    assert watched.events == []


def test_what_no_sensor_can_measure_is_refused_told_once_a_kind_and_counted():
    watched = Watched()
    fast = MACHINE.sensors[IMU].gyro_range_rad_s
    guard = watched.at(0.1)
    assert guard.refuses(sample(0.05, 2.0 * fast))
    assert guard.refuses(sample(0.06, 3.0 * fast))
    assert [type(one) for one in watched.events] == [ObservationRefused]
    assert (watched.events[0].sensor, watched.events[0].stamp_s) == (IMU, 0.05)
    assert sum(guard.refused.values()) == 2
    assert len(guard.refused) == 1  # counted together, without numbers
    assert not guard.refuses(sample(0.07))
    assert guard.refuses(sample(0.08, 2.0 * fast))
    assert len(watched.events) == 2  # told anew after a good one


def test_what_is_of_no_sensor_is_let_through():
    assert not Watched().guard.refuses("another observation")


def test_scans_are_fused_while_the_estimate_may_be_used_and_its_end_is_told_once():
    watched = Watched(state(0.0, "LOST"), watch={"estimate": EstimateRule(do="tell")})
    guard = watched.guard
    assert [guard.may_fuse(0.0) for _ in range(3)] == [False] * 3
    assert [type(one) for one in watched.events] == [ScansNotFused]
    assert watched.events[0].reason == "the estimate is LOST: why it is LOST"
    assert (guard.scans_not_fused, guard.stale_states, guard.refused) == (3, 0, {})
    watched.streams.newest = state(0.0)
    assert guard.may_fuse(0.0)
    watched.streams.newest = state(0.0, "LOST")
    assert not guard.may_fuse(0.0)
    assert len(watched.events) == 2


def test_a_map_that_is_too_far_behind_gets_no_further_scan_until_it_has_caught_up():
    watched = Watched(state(0.0))
    assert watched.guard.may_fuse(0.0, MOST_BEHIND - 1)
    assert not watched.guard.may_fuse(0.0, MOST_BEHIND)
    assert watched.events[0].reason.startswith("the map is 50 scan pairs behind")
    assert watched.guard.may_fuse(0.0, MOST_BEHIND - 1)
    assert watched.guard.scans_not_fused == 1


def test_without_a_rule_only_the_age_of_a_usable_estimate_counts():
    guard = Watched(state(0.0)).guard
    assert guard.may_fuse(AGE_S)
    assert not guard.may_fuse(AGE_S + 0.01)
    assert guard.age_limit_s == AGE_S


def test_a_guard_without_streams_refuses_no_scan():
    guard = Watched(state(0.0, "LOST"), watch={"estimate": EstimateRule(do="tell")}).guard
    guard.bind(None)
    assert guard.may_fuse(0.0)
    assert guard.step(0.0) == guard.step(0.0)


def test_a_state_that_is_too_old_is_judged_as_the_state_of_now():
    watched = Watched(has_judge=True)
    guard = watched.at(1.0)
    guard.judge(state(1.0))
    guard.judge(state(1.0 - AGE_S))
    assert guard.stale_states == 0
    guard.judge(state(0.9 - AGE_S))
    assert guard.stale_states == 1
    stamps_s = [one.stamp_s for one in guard.judged]
    assert stamps_s == pytest.approx([1.0, 1.0 - AGE_S, 1.0])


def test_without_a_judge_no_state_is_kept():
    guard = Watched().guard
    guard.judge(state())
    assert len(guard.judged) == 0


def test_commands_and_stops_reach_the_robot():
    watched = Watched()
    watched.robot.command(Drive(0.5, 0.0))
    watched.robot.stop()
    assert [one.speed_m_s for one in watched.robot.given] == [0.5]
    assert watched.robot.stops == 1


def test_a_condition_that_ends_the_mission_is_recorded_with_its_reason():
    fields = dict.fromkeys(Decision.__dataclass_fields__)
    decision = Decision(**{**fields, "condition": "geofence", "reason": "it has left"})
    fault = failure_of(decision)
    assert fault.summary == "watched condition 'geofence' failed: it has left"
    assert fault.name == "geofence"


# --- samples of a long run


def test_all_values_are_kept_up_to_a_number_and_then_every_second():
    samples = Samples(4)
    kept = []
    for value in range(12):
        samples.append(value)
        kept.append(list(samples))
    assert kept[3] == [0, 1, 2, 3]
    assert kept[4] == [0, 2, 4]
    assert kept[7] == [0, 2, 4, 6]
    assert kept[8] == [0, 4, 8]
    assert samples.total == 12
    assert len(samples) == len(list(samples)) <= 4


def test_an_arm_that_does_not_follow_what_the_robot_has_taken_is_noticed():
    names = MACHINE.arm_names
    way = np.vstack([MACHINE.posture("carry"), MACHINE.posture("carry") + 0.5])
    times = np.array([0.0, 4.0])
    path = JointTrajectory(names, times, way, np.full_like(way, 0.125))
    watched = Watched(watch={TRACKING: Rule(do="stop")})
    q = np.append(way[0], 0.5)
    still = JointSample(3.0, MACHINE.joint_names, q, np.zeros(len(q)), np.zeros(len(q)))
    watched.streams.joints = still
    assert watched.guard.step(3.0).wish is Wish.GO_ON  # nothing is commanded
    watched.robot.command(Follow(path))
    decision = watched.guard.step(3.0)
    assert (decision.wish, decision.condition) == (Wish.STOP, TRACKING)
    assert decision.reason.endswith("off its path")
    watched.robot.stop()
    assert watched.guard.step(3.0).wish is Wish.GO_ON  # it stands on its path
