"""Faults begin and end by the machine's time, act on what they are of, and are reported."""

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.events.event import plain
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.faults import injector as injector_module
from executive.faults.description import ActuatorFault, PluginFault, SensorFault
from executive.faults.injector import Injector
from executive.faults.plugin_faults import InjectedError
from executive.interfaces.facilities import Breakable
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.messages.imu import ImuSample
from executive.messages.trajectory import JointTrajectory

MACHINE = load_machine("m545")
NAMES = tuple(MACHINE.arm_names)
TICK_S = 0.5
FORWARD = MoveJaws(0.3, 8000.0)


class Robot:
    """Takes commands, and sends a sample of two inertial sensors at each reading."""

    def __init__(self):
        self.commands, self.stops = [], 0

    def read(self, until_s):
        samples = ("imu_cabin", "imu_base")
        return tuple(ImuSample(until_s, name, np.ones(3), np.ones(3)) for name in samples)

    def command(self, command):
        self.commands.append(command)

    def stop(self):
        self.stops += 1


class WeakRobot(Robot, Breakable):
    """Simulates the loss of pressure itself."""

    def __init__(self):
        super().__init__()
        self.shares = []

    def weaken(self, joint, share):
        self.shares.append((joint, share))


class Segmenter:
    """Counts its calls."""

    def __init__(self):
        self.calls = 0

    def segment(self, cloud, *, least=1):
        self.calls += 1
        return f"{cloud} {least}"


class Injected:
    """Faults of a mission in ticks of half a second."""

    def __init__(self, *faults, robot=None, **plugins):
        self.clock, self.events = SimulatedClock(), []
        self.robot = robot or Robot()
        self.injector = Injector(faults, MACHINE, 1, self.clock)
        self.injector.install({"robot": self.robot, **plugins}, self.events.append)

    def go_to(self, time_s):
        """Step at each tick up to a time, this one included."""
        while True:
            self.injector.step()
            if self.clock.machine_s() >= time_s:
                return
            self.clock.advance(TICK_S)

    def told(self):
        return [(event.kind, *event.payload().values()) for event in self.events]


def path(lasts_s=20.0, speed=0.2):
    times = np.array([0.0, lasts_s])
    motion = speed * times[:, None] * np.ones(len(NAMES))
    return JointTrajectory(NAMES, times, motion, np.full_like(motion, speed))


def test_without_faults_nothing_is_put_in_front_of_the_robot():
    found = Injected()
    found.go_to(2.0)
    assert not {"read", "command", "stop"} & set(vars(found.robot))
    assert (found.events, found.injector.report()) == ([], ())
    assert not found.injector.is_aimed_at("segmentation", "segment")
    assert found.injector.decide("segmentation", "segment") is None


def test_a_fault_of_a_sensor_alters_its_samples_alone_while_it_lasts():
    found = Injected(SensorFault(at=1.0, lasts=1.0, sensor="imu_base", how="duplicate"))
    frames = []
    for time_s in (0.5, 1.0, 1.5, 2.0):
        found.go_to(time_s)
        frames.append([one.frame for one in found.robot.read(time_s)])
    cabin, base = "imu_cabin", "imu_base"
    assert frames == [[cabin, base], [cabin, base, base], [cabin, base, base], [cabin, base]]
    assert found.told() == [
        ("fault_injected", 1, base, "duplicate", False),
        ("fault_removed", 1, base, "duplicate", 2),
    ]
    assert plain(found.injector.report()) == [
        {
            "number": 1,
            "target": base,
            "how": "duplicate",
            "spans": [{"from_s": 1.0, "to_s": 2.0}],
            "acted": 2,
        }
    ]


def test_faults_of_one_sensor_act_one_after_the_other_and_each_by_itself():
    twice = SensorFault(at=1.0, sensor="imu_base", how="duplicate")
    lost = SensorFault(at=2.0, sensor="imu_base", how="silent")
    found = Injected(twice, twice, lost)
    counts = []
    for time_s in (1.0, 2.0):
        found.go_to(time_s)
        counts.append(len(found.robot.read(time_s)))
    assert counts == [1 + 4, 1]
    assert [one.acted for one in found.injector.report()] == [2, 4, 4]


def test_a_fault_goes_on_while_the_mission_is_paused():
    found = Injected(SensorFault(at=1.0, sensor="imu_base", how="silent"))
    found.clock.advance(TICK_S)
    found.clock.pause()
    found.go_to(1.0)
    assert (found.clock.now_s(), found.told()[0][0]) == (0.5, "fault_injected")


def test_a_fault_that_waits_for_a_node_is_begun_by_its_start_alone():
    found = Injected(SensorFault(node="Scan", sensor="imu_base", how="silent"))
    for node, event in [
        ("main/0:Scan", NodeEnded(NodeResult.SUCCESS, "")), ("main/1:Pick", NodeStarted()),
    ]:  # fmt: skip
        found.injector.heed(node, event)
    found.go_to(1.0)
    assert found.events == []
    found.injector.heed("main/0:Scan", NodeStarted())
    found.go_to(1.5)
    assert plain(found.injector.report()[0].spans) == [{"from_s": 1.0, "to_s": None}]


def test_a_robot_is_commanded_through_the_faults_that_are_active():
    found = Injected(ActuatorFault(at=1.0, actuator="jaws", how="sluggish", share=0.5))
    found.robot.command(FORWARD)
    found.go_to(1.0)
    found.robot.command(FORWARD)
    found.robot.command(SwitchLidars(True))
    assert found.robot.commands[0] == FORWARD
    assert found.robot.commands[-2:] == [MoveJaws(0.3, 4000.0), SwitchLidars(True)]
    assert found.injector.report()[0].acted == 2  # its begin, and one command


def test_a_command_that_a_fault_has_swallowed_reaches_no_later_fault():
    found = Injected(
        ActuatorFault(at=1.0, actuator="jaws", how="open"),
        ActuatorFault(at=1.0, actuator="jaws", how="sluggish"),
    )
    found.go_to(1.0)
    before = len(found.robot.commands)
    found.robot.command(FORWARD)
    assert len(found.robot.commands) == before
    assert [one.acted for one in found.injector.report()] == [2, 1]


def test_a_fault_of_the_arm_shows_once_it_withholds_more_than_the_tracking_error():
    found = Injected(ActuatorFault(at=1.0, lasts=6.0, actuator="arm", how="sluggish", share=0.5))
    found.robot.command(Follow(path()))
    found.go_to(6.5)
    (begun, shows) = found.told()
    assert begun == ("fault_injected", 1, "arm", "sluggish", True)
    assert shows[:2] == ("fault_shows", 1)
    error, lag_s = MACHINE.stance.tracking_error, MACHINE.stance.tracking_lag_s
    # Since the fault began, a sound arm has made 0.2 (t - 1 - lag) at least, this one 0.1 (t - 1).
    times = np.arange(1.0, 7.0, TICK_S)
    withheld = np.maximum(0.2 * (times - 1.0 - lag_s), 0.0) - 0.1 * (times - 1.0)
    assert shows[2] == pytest.approx(withheld[withheld > error][0])
    found.go_to(7.0)
    assert found.told()[2] == ("fault_removed", 1, "arm", "sluggish", 1)


def test_a_fault_that_ends_before_it_shows_is_never_seen():
    found = Injected(ActuatorFault(at=1.0, lasts=1.0, actuator="arm", how="no_pressure"))
    found.go_to(2.0)
    found.robot.command(Follow(path()))
    found.go_to(6.0)
    assert [kind for kind, *_ in found.told()] == ["fault_injected", "fault_removed"]


def test_a_robot_that_stops_follows_no_path_that_a_fault_could_slow():
    found = Injected(ActuatorFault(at=1.0, actuator="arm", how="sluggish"))
    found.robot.command(Follow(path()))
    found.robot.stop()
    found.go_to(8.0)
    assert found.robot.stops == 1
    assert len(found.robot.commands) == 1
    assert [kind for kind, *_ in found.told()] == ["fault_injected"]


def test_a_robot_that_loses_pressure_itself_has_it_back_after_the_fault():
    robot = WeakRobot()
    joint, jaw = NAMES[0], MACHINE.jaw.name
    found = Injected(
        ActuatorFault(at=1.0, lasts=1.0, actuator=joint, how="no_pressure"),
        ActuatorFault(at=3.0, actuator="jaws", how="no_pressure"),
        robot=robot,
    )
    found.go_to(4.0)
    assert robot.shares == [(joint, 0.0), (joint, 1.0), (jaw, 0.0)]


def test_a_verb_fails_for_so_many_calls_while_its_fault_is_active():
    segmenter = Segmenter()
    fault = PluginFault(at=1.0, plugin="segmentation", verb="segment", how="raise", calls=2)
    found = Injected(fault, segmentation=segmenter)
    assert found.injector.is_aimed_at("segmentation", "segment")
    assert not found.injector.is_aimed_at("segmentation", "other")
    assert not found.injector.is_aimed_at("mapping", "segment")
    assert segmenter.segment("cloud", least=3) == "cloud 3"
    found.go_to(1.0)
    for _ in range(2):
        with pytest.raises(InjectedError):
            segmenter.segment("cloud")
    assert segmenter.segment("cloud") == "cloud 1"
    assert (segmenter.calls, found.injector.report()[0].acted) == (2, 2)


def test_the_first_active_fault_of_a_verb_decides_about_its_call():
    given = {"plugin": "segmentation", "verb": "segment"}
    faults = [
        PluginFault(at=5.0, how="die", **given),
        PluginFault(at=1.0, how="hang", plugin="mapping", verb="segment"),
        PluginFault(at=1.0, how="nan", calls=1, **given),
        PluginFault(at=1.0, how="late", delay=3.0, **given),
    ]
    found = Injected(*faults)
    assert found.injector.decide("segmentation", "segment") is None
    found.go_to(1.0)
    decided = [found.injector.decide("segmentation", "segment") for _ in range(3)]
    assert decided == [faults[2], faults[3], faults[3]]


@pytest.mark.parametrize(("given", "delay_s"), [({}, 5.0), ({"delay": 2.0}, 2.0)])
def test_a_late_verb_of_each_plugin_is_late_by_what_the_file_says(monkeypatch, given, delay_s):
    asked = []

    def misbehave(how, delay_s, call):
        asked.append((how, delay_s))
        return call()

    monkeypatch.setattr(injector_module, "misbehave", misbehave)
    plugins = Segmenter(), Segmenter()
    fault = PluginFault(at=0.0, plugin="monitoring", verb="segment", how="late", **given)
    found = Injected(fault, monitoring=plugins)
    found.go_to(0.0)
    assert [one.segment("cloud", least=2) for one in plugins] == ["cloud 2", "cloud 2"]
    assert asked == [("late", delay_s)] * 2


def test_faults_begin_and_show_each_by_itself():
    stuck = SensorFault(at=1.0, sensor="imu_base", how="stuck")
    other = SensorFault(at=2.0, sensor="imu_cabin", how="stuck")
    found = Injected(stuck, other, ActuatorFault(at=3.0, actuator="arm", how="sluggish"))
    held = []

    def read(until_s):
        return [
            ImuSample(until_s, name, until_s * np.ones(3), np.ones(3))
            for name in ("imu_base", "imu_cabin")
        ]

    found.robot = Robot()
    found.robot.read = read
    found.injector.install({"robot": found.robot}, found.events.append)
    for time_s in (1.0, 2.0, 3.0):
        found.go_to(time_s)
        held.append([one.angular_velocity_rad_s[0] for one in found.robot.read(time_s)])
    assert held == [[1.0, 1.0], [1.0, 2.0], [1.0, 2.0]]
    assert [is_hidden for *_, is_hidden in found.told()] == [False, False, True]


def test_equal_faults_of_two_sensors_draw_their_chances_apart():
    faults = [
        SensorFault(at=0.5, sensor=name, how="intermittent", share=0.5)
        for name in ("imu_cabin", "imu_base")
    ]
    found = Injected(*faults)
    found.go_to(0.5)
    left = [[one.frame for one in found.robot.read(0.5)] for _ in range(20)]
    # With equal draws both samples of a reading would always be lost together.
    assert any(len(frames) == 1 for frames in left)
