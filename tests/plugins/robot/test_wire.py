"""The driver of a machine behind the wire, on a connection and a clock that the test holds."""

import math
from collections import deque
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot import wire
from executive_plugins.robot.settings import WireSettings
from executive_plugins.robot.wire import WireRobot

from executive.errors import ConfigError, DataError, RobotError
from executive.messages.command import MoveJaws
from executive.messages.imu import ImuSample
from executive.wire.frame import Frame, Kind
from executive.wire.payload import pack

ANSWER_S, SILENCE_S = 0.4, 0.6


class Clock:
    """A wall clock that stands unless a wait or the test moves it."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s


class Wire:
    """The machine's end of a connection: what each look at it finds, and what it was sent.

    Attributes:
        looks: Frames of the next looks; with an answer to nobody yet, a function of the question.
        sent: What the driver has sent, and `waits` how long it was ready to wait at each look.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.looks: deque[list] = deque()
        self.sent: list[Frame] = []
        self.waits: list[float] = []
        self.is_open = True

    def send(self, frame: Frame) -> bool:
        self.sent.append(frame)
        return self.is_open

    def receive(self, wait_s: float = 0.0):
        self.waits.append(wait_s)
        found = self.looks.popleft() if self.looks else []
        if not found:
            self._clock.now_s += wait_s
        yield from (one(self.sent[-1].sequence) if callable(one) else one for one in found)

    def close(self) -> None:
        self.is_open = False


def done(sequence: int) -> Frame:
    return Frame(Kind.DONE, sequence=sequence)


def welcome(**head: object):
    return lambda sequence: Frame(Kind.WELCOME, head, b"", sequence)


def seen(time_s: float, *stamps_s: float, **head: object) -> Frame:
    """A frame of inertial samples, from a machine whose clock shows a time."""
    samples = [ImuSample(s, "imu_cabin", np.zeros(3), np.zeros(3)) for s in stamps_s]
    objects, body = pack(samples)
    return Frame(Kind.OBSERVATIONS, {"time_s": time_s, "observations": objects, **head}, body)


@pytest.fixture
def clock(monkeypatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(wire, "time", found)
    return found


@pytest.fixture
def machine(monkeypatch, clock) -> Wire:
    end = Wire(clock)
    where = SimpleNamespace(connect=lambda _: None)
    monkeypatch.setattr(wire, "Address", SimpleNamespace(parse=lambda _: where))
    for name in ("Connection", "ReadAheadConnection"):
        monkeypatch.setattr(wire, name, lambda _: end)
    return end


def settings(**changed: object) -> WireSettings:
    limits = {"answer_limit": ANSWER_S, "silence_limit": SILENCE_S}
    return WireSettings.model_validate({"address": "unix:/m.sock", **limits, **changed})


@pytest.fixture
def robot(machine) -> WireRobot:
    """A driver of a simulated machine, connected and not yet read."""
    machine.looks += [[welcome(is_simulated=True)], [done]]
    found = WireRobot(settings())
    found.start()
    return found


def stamps(robot: WireRobot, until_s: float) -> list[float]:
    return [round(one.stamp_s, 9) for one in robot.read(until_s)]


def test_it_says_hello_learns_what_the_machine_is_and_resets_it(machine) -> None:
    machine.looks += [[welcome(is_ideal=True, lacks=["imu_cabin"], behind_s=0.25)], [done]]
    robot = WireRobot(settings(model="m545"))
    robot.start()
    assert [(one.kind, one.sequence) for one in machine.sent] == [(Kind.HELLO, 1), (Kind.RESET, 2)]
    assert machine.sent[0].head == {"role": "executive", "model": "m545"}
    assert (robot.is_ideal, robot.lacks) == (True, frozenset({"imu_cabin"}))
    assert robot.behind_s() == 0.25
    assert robot.address() == "unix:/m.sock"


def test_a_machine_that_says_nothing_of_itself_is_real_and_lacks_nothing(machine) -> None:
    machine.looks += [[welcome()]]
    robot = WireRobot(settings(reset_at_start=False))
    robot.start()
    assert [one.kind for one in machine.sent] == [Kind.HELLO]
    assert (robot.is_ideal, robot.lacks, robot.behind_s()) == (False, frozenset(), 0.0)
    machine.looks += [[seen(50.0)]]
    robot.read(0.0)
    assert robot.latest_s() == math.inf  # it cannot be awaited


def test_a_machine_that_refuses_is_left(machine) -> None:
    machine.looks += [[lambda n: Frame(Kind.REFUSED, {"reason": "it is driven"}, b"", n)]]
    robot = WireRobot(settings())
    with pytest.raises(RobotError, match=r"^the machine refuses: it is driven$"):
        robot.start()
    assert not machine.is_open
    with pytest.raises(RobotError, match=r"call start\(\) first"):
        robot.read(0.0)


def test_where_nobody_listens_the_message_names_the_address(monkeypatch) -> None:
    robot = WireRobot(settings(address="unix:/nobody/m.sock"))
    with pytest.raises(ConfigError, match=r"no machine listens at unix:/nobody/m\.sock \(No such"):
        robot.start()
    with pytest.raises(DataError, match="the machine that makes the survey is gone"):
        robot.survey_of_site(3)


def test_a_look_for_what_has_arrived_does_not_wait(robot, machine, clock) -> None:
    before_s, machine.waits = clock.now_s, []
    robot.read(0.0)
    robot.latest_s()
    assert machine.waits == [0.0]  # not both: before anything arrived, nothing is awaited
    machine.looks += [[seen(50.0)]]
    robot.read(0.1)
    robot.latest_s()
    assert machine.waits == [0.0, 0.0, 0.0]
    assert clock.now_s == before_s


def test_a_question_waits_for_its_own_answer_as_long_as_is_allowed(robot, machine, clock) -> None:
    machine.waits = []
    machine.looks += [[Frame(Kind.DONE, sequence=1)], [], [done]]  # one to an earlier question
    begun_s = clock.now_s
    with pytest.raises(RobotError, match=r"did not answer STOP within 0\.4 s"):
        robot.stop()
    assert machine.waits == pytest.approx([ANSWER_S, ANSWER_S])
    assert clock.now_s == pytest.approx(begun_s + ANSWER_S)
    machine.looks.clear()
    machine.looks += [[Frame(Kind.STATUS, {}, b"", 0)], [done]]
    robot.resume()
    assert [one.kind for one in machine.sent[-2:]] == [Kind.STOP, Kind.RESUME]
    assert [one.sequence for one in machine.sent] == [1, 2, 3, 4]


def test_a_machine_that_is_gone_is_not_waited_for(robot, machine, clock) -> None:
    begun_s = clock.now_s
    machine.close()
    with pytest.raises(RobotError, match="did not answer PAUSED"):
        robot.paused(0.0)
    assert clock.now_s == begun_s
    with pytest.raises(RobotError, match="has sent nothing for"):
        robot.read(0.0)


@pytest.mark.parametrize(
    ("verb", "kind"),
    [
        (lambda robot: robot.stop(), Kind.STOP),
        (lambda robot: robot.resume(), Kind.RESUME),
        (lambda robot: robot.reset(), Kind.RESET),
        (lambda robot: robot.paused(1.0), Kind.PAUSED),
        (lambda robot: robot.resumed(1.0), Kind.RESUMED),
        (lambda robot: robot.safe_stop("a test"), Kind.SAFE_STOP),
        (lambda robot: robot.command(MoveJaws(0.3, 8000.0)), Kind.COMMAND),
    ],
)
def test_each_verb_is_a_frame_of_its_kind_and_fails_if_it_is_refused(
    robot, machine, verb, kind
) -> None:
    machine.looks += [[done], [lambda n: Frame(Kind.REFUSED, {}, b"", n)]]
    verb(robot)
    assert machine.sent[-1].kind is kind
    with pytest.raises(RobotError, match="the machine refuses"):
        verb(robot)


def test_what_is_measured_while_an_answer_is_awaited_is_read_later_and_in_order(
    robot, machine
) -> None:
    machine.looks += [[seen(50.0)]]
    assert stamps(robot, 2.0) == []  # the machine's clock shows 50 s, the mission's 2 s
    machine.looks += [[seen(50.3, 50.2, 50.1), done], [seen(50.4, 50.15)]]
    robot.stop()
    assert stamps(robot, 2.4) == [2.1, 2.15, 2.2]
    assert stamps(robot, 2.4) == []
    assert robot.zero_s() == 48.0
    assert robot.keep() == {"zero_s": 48.0}


def test_what_was_measured_before_the_mission_is_dropped_and_counted(robot, machine) -> None:
    assert robot.keep() == {}
    assert robot.zero_s() == 0.0
    machine.looks += [[seen(49.9, 49.8, 49.9), seen(50.0, 49.95, 50.0)]]
    assert stamps(robot, 0.0) == [0.0]  # the newest frame was measured just now
    assert robot.dropped == 3
    machine.looks += [[seen(50.1, 49.99)]]
    assert stamps(robot, 0.1) == []
    assert robot.dropped == 4


def test_each_read_tells_the_machine_that_the_executive_is_alive(robot, machine) -> None:
    machine.sent.clear()
    for _ in range(3):
        robot.read(0.0)
    assert [(one.kind, one.sequence) for one in machine.sent] == [(Kind.ALIVE, 0)] * 3


def test_silence_is_measured_from_what_was_heard_last(robot, machine, clock) -> None:
    clock.now_s += 30.0  # the start of other plugins
    machine.looks += [[seen(50.0)]]
    robot.read(0.0)
    clock.now_s += 0.98 * SILENCE_S
    robot.read(0.0)
    clock.now_s += 0.04 * SILENCE_S
    with pytest.raises(RobotError, match=r"has sent nothing for 0\.61 s"):
        robot.read(0.0)
    machine.looks += [[Frame(Kind.STATUS)]]  # not only observations count
    robot.read(0.0)


def test_a_stop_of_the_machine_is_an_error_and_one_that_was_asked_for_is_none(
    robot, machine
) -> None:
    machine.looks += [[seen(50.0, latched="no pressure")]]
    with pytest.raises(RobotError, match="stopped by itself: no pressure"):
        robot.read(0.0)
    machine.looks += [[seen(50.1, latched="no pressure"), done]]
    robot.reset()
    robot.read(0.1)  # what was sent before the reset
    assert robot.latched() == ""
    machine.looks += [[done], [seen(50.2, latched="a test")]]
    robot.safe_stop("a test")
    assert machine.sent[-1].head == {"reason": "a test"}
    assert robot.latched() == "a test"
    robot.read(0.2)
    assert robot.latched() == "a test"
    machine.looks += [[done], [seen(50.3, latched="again")]]
    robot.reset()
    with pytest.raises(RobotError, match="stopped by itself: again"):
        robot.read(0.3)


def test_the_first_reason_of_a_stop_stays(robot, machine) -> None:
    machine.looks += [[done], [done]]
    robot.safe_stop("first")
    robot.safe_stop("second")
    assert robot.latched() == "first"


def test_a_simulated_machine_is_awaited_up_to_what_it_has_sent(robot, machine) -> None:
    assert robot.latest_s() == math.inf
    machine.looks += [[seen(50.0)]]
    robot.read(2.0)
    assert robot.latest_s() == pytest.approx(2.02)  # and a little, in which nothing may arrive
    machine.looks += [[seen(50.1), seen(50.3)]]
    assert robot.latest_s() == pytest.approx(2.32)


def test_a_mission_that_is_taken_up_counts_the_time_in_between(robot, machine, clock) -> None:
    assert robot.taken_up_s(7.0) == 7.0  # an earlier process has kept nothing
    robot.restore({"zero_s": 48.0})
    machine.looks += [[seen(60.0)]]
    robot.read(0.0)
    assert robot.zero_s() == 48.0  # as it was kept
    clock.now_s += 0.5
    assert robot.taken_up_s(7.0) == pytest.approx(12.5)
    assert robot.zero_s() == pytest.approx(48.0)


def test_a_machine_that_was_begun_anew_goes_on_at_the_time_of_the_cut(robot, machine) -> None:
    robot.restore({"zero_s": 48.0})
    machine.looks += [[seen(3.0)]]
    robot.read(0.0)
    assert robot.taken_up_s(7.0) == 7.0
    assert robot.zero_s() == pytest.approx(-4.0)


def test_the_survey_comes_over_a_connection_of_its_own(robot, machine) -> None:
    machine.sent.clear()
    machine.looks += [[], [lambda n: Frame(Kind.REFUSED, {"reason": "no site"}, b"", n)]]
    with pytest.raises(DataError, match=r"^no survey: no site$"):
        robot.survey_of_site(5)
    assert [(one.kind, one.head, one.sequence) for one in machine.sent] == [
        (Kind.SURVEY, {"seed": 5}, 1)
    ]
    assert not machine.is_open  # here the same; it is closed whatever came
    with pytest.raises(DataError, match="no survey: the machine that makes it has ended"):
        robot.survey_of_site(5)
