"""A machine behind the wire: driven by one executive, stopped by silence or by a supervisor."""

import socket
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.robot.settings import KinematicSettings, WireSettings
from executive_plugins.robot.wire import WireRobot

from executive.errors import ConfigError, RobotError
from executive.machine.machine import load_machine
from executive.messages.command import Follow
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from executive.supervision.link import MachineLink
from executive.wire import machine_server
from executive.wire.address import Address
from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind
from executive.wire.machine_server import MachineServer

SILENCE_S = 0.3
SLACK_S = 1.0  # for a busy computer to schedule the thread that serves


@pytest.fixture
def machine(tmp_path):
    """A server with a kinematic machine, in a thread; its address as text."""
    robot = KinematicRobot(KinematicSettings(), load_machine("m545"))
    address = Address(str(tmp_path / "machine.sock"))
    server = MachineServer(robot, "m545", address, SILENCE_S)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    yield server
    server.is_ended = True
    thread.join(5)


@pytest.fixture
def driver(machine):
    robot = WireRobot(settings_for(machine))
    robot.start()
    yield robot
    robot.close()


@pytest.fixture
def link():
    """A supervisor's connection."""
    found = MachineLink()
    yield found
    found.close()


def settings_for(machine):
    return WireSettings(address=str(machine.address), answer_limit=5.0, silence_limit=5.0)


def swing(q):
    """A slow turn of the cabin from a posture, twenty seconds long."""
    times = np.linspace(0.0, 20.0, 41)
    s = times / 20.0
    blend, rate = s**2 * (3 - 2 * s), 6 * s * (1 - s) / 20.0
    return Follow(
        JointTrajectory(
            ("J_TURN",),
            times,
            (q + 3.0 * blend)[:, None],
            3.0 * rate[:, None],
        )
    )


def keep_alive(robot, seconds, begun):
    """Read for a while, and return the joint samples."""
    found = []
    limit_s = time.monotonic() + seconds
    while time.monotonic() < limit_s:
        found += [o for o in robot.read(time.monotonic() - begun) if isinstance(o, JointSample)]
        time.sleep(0.02)
    return found


def begin_to_move(driver):
    begun = time.monotonic()
    sample = keep_alive(driver, 0.3, begun)[-1]
    driver.command(swing(sample.of("J_TURN")[0]))
    moving = keep_alive(driver, 1.0, begun)[-1]
    assert abs(moving.of("J_TURN")[1]) > 1e-3
    return begun


def test_observations_arrive_with_stamps_of_the_mission(driver):
    begun = time.monotonic()
    samples = keep_alive(driver, 1.0, begun)
    stamps = [one.stamp_s for one in samples]
    assert stamps == sorted(stamps)
    assert 0.0 <= stamps[0] < stamps[-1] < 1.0 + SLACK_S


def test_a_silent_executive_brings_the_machine_to_rest(machine, driver):
    begun = begin_to_move(driver)
    time.sleep(SILENCE_S + SLACK_S)
    with pytest.raises(RobotError, match=r"by itself: the executive was silent for 0\.[34]"):
        keep_alive(driver, 2.0, begun)
    with pytest.raises(RobotError, match="a safe stop is latched"):
        driver.command(swing(0.0))


def test_an_executive_that_is_gone_brings_the_machine_to_rest(machine, driver, link):
    begin_to_move(driver)
    driver.close()
    report = wait_for(link, machine, lambda report: report.get("at_rest"))
    assert report["latched"] == "the executive's connection ended"


def test_an_executive_may_follow_at_once_on_one_that_has_ended(machine):
    for _ in range(20):
        robot = WireRobot(settings_for(machine))
        robot.start()
        robot.read(0.0)
        robot.close()


def wait_for(link, machine, condition):
    limit_s = time.monotonic() + 5
    while time.monotonic() < limit_s:
        link.keep(str(machine.address))
        if link.report and condition(link.report):
            return link.report
        time.sleep(0.01)
    raise AssertionError(f"not within 5 s: {link.report}")


def test_a_supervisor_stops_a_machine_that_an_executive_drives(machine, driver, link):
    begun = begin_to_move(driver)
    wait_for(link, machine, lambda report: not report["latched"])
    assert link.stop("supervisor: a test")
    with pytest.raises(RobotError, match="stopped by itself: supervisor: a test"):
        keep_alive(driver, 2.0, begun)


def test_a_stop_is_reset_when_the_machine_is_at_rest(machine, driver, link):
    begun = begin_to_move(driver)
    driver.safe_stop("a test")
    with pytest.raises(RobotError, match="still moves"):
        driver.reset()
    keep_alive(driver, 0.2, begun)  # it asked for the stop itself
    assert driver.latched() == "a test"
    wait_for(link, machine, lambda report: report["at_rest"])
    driver.reset()
    sample = keep_alive(driver, 0.2, begun)[-1]
    driver.command(swing(sample.of("J_TURN")[0]))


def test_a_refused_command_says_why(driver):
    keep_alive(driver, 0.2, time.monotonic())
    with pytest.raises(RobotError, match="refuses: trajectory starts J_TURN"):
        driver.command(swing(2.0))


def test_one_executive_at_a_time(machine, driver):
    with pytest.raises(RobotError, match="another executive drives the machine"):
        WireRobot(settings_for(machine)).start()


def test_a_mission_for_another_machine_is_refused(machine):
    other = WireRobot(settings_for(machine).model_copy(update={"model": "other"}))
    with pytest.raises(RobotError, match="'m545', and the mission is for a 'other'"):
        other.start()


def test_no_machine_at_an_address_is_an_error_of_the_input(tmp_path):
    robot = WireRobot(WireSettings(address=f"unix:{tmp_path}/nobody.sock"))
    with pytest.raises(ConfigError, match=r"no machine listens at unix:.*executive simulate"):
        robot.start()


def test_a_guest_without_a_role_moves_nothing(machine):
    guest = Connection(Address.parse(str(machine.address)).connect(1.0))
    guest.send(Frame(Kind.RESET, sequence=4))
    answers = list(guest.receive(5.0))
    assert (answers[0].kind, answers[0].sequence) == (Kind.REFUSED, 4)
    guest.close()


def test_nonsense_ends_its_connection_and_no_other(machine, driver):
    found = Address.parse(str(machine.address)).connect(1.0)
    found.sendall(b"GET / HTTP/1.1\r\n\r\n")
    guest = Connection(found)
    assert "no frame of the robot wire" in next(iter(guest.receive(5.0))).head["reason"]
    guest.close()
    assert keep_alive(driver, 0.3, time.monotonic())


def test_it_waits_for_room_only_where_something_is_left_to_send(tmp_path, monkeypatch):
    robot = KinematicRobot(KinematicSettings(), load_machine("m545"))
    server = MachineServer(robot, "m545", Address(str(tmp_path / "machine.sock")), SILENCE_S)
    (reads_nothing, _), (reads_all, _) = ends = socket.socketpair(), socket.socketpair()
    server._guests = [Connection(reads_nothing), Connection(reads_all)]
    server._guests[0].post(Frame(Kind.OBSERVATIONS, body=bytes(32 * 2**20)))
    server._guests[1].post(Frame(Kind.OBSERVATIONS))
    waited = []
    monkeypatch.setattr(
        machine_server, "select", SimpleNamespace(select=lambda *found: waited.append(found[1]))
    )
    server._wait()
    assert waited == [[reads_nothing.fileno()]]
    for end in (*ends[0], *ends[1], server._listening):
        end.close()
