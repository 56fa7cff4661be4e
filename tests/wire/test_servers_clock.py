"""A machine's clock beside the wall clock: it goes in steps, may slip, and notices silence."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.joints import JointSample
from executive.wire import machine_server
from executive.wire.address import Address
from executive.wire.frame import Frame, Kind
from executive.wire.machine_server import SLIP_S, STATUS_S, STEP_S, MachineServer, Simulation

NAMES = load_machine("m545").joint_names


class Machine:
    """A robot that tells when it is read, and whether it was stopped."""

    def __init__(self):
        self.read_at, self.stopped, self.asked = [], [], []
        self.speed = 0.0

    def read(self, time_s):
        self.read_at.append(time_s)
        velocity = np.zeros(len(NAMES))
        velocity[1] = -self.speed
        return [JointSample(time_s, NAMES, np.zeros(len(NAMES)), velocity, np.zeros(len(NAMES)))]

    def latched(self):
        return self.stopped[0] if self.stopped else ""

    def safe_stop(self, reason):
        self.stopped.append(reason)

    def behind_s(self):
        return 0.25

    def __getattr__(self, verb):
        return lambda *given: self.asked.append((verb, *given))


class Guest:
    """A connection that keeps what is posted."""

    is_open = True

    def __init__(self):
        self.posted = []

    def post(self, frame):
        self.posted.append(frame)


@pytest.fixture
def served(tmp_path, monkeypatch):
    """Return a server whose wall clock stands still until a test moves it."""
    wall = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr(machine_server, "time", SimpleNamespace(monotonic=lambda: wall.now_s))
    tended = []
    server = MachineServer(
        Machine(),
        "m545",
        Address(str(tmp_path / "m.sock")),
        0.3,
        Simulation(begins_s=2.0, tend=lambda one: tended.append(one.time_s)),
    )
    yield SimpleNamespace(server=server, wall=wall, robot=server._robot, tended=tended)
    server._listening.close()


def test_the_clock_goes_on_by_a_step_once_that_has_passed(served):
    server, wall = served.server, served.wall
    server._live()
    assert (server.time_s, served.robot.read_at) == (2.0, [])
    wall.now_s += 0.9 * STEP_S
    server._live()
    assert served.robot.read_at == []
    wall.now_s += 1.2 * STEP_S
    server._live()
    server._live()
    server._live()  # only two have passed
    assert served.robot.read_at == pytest.approx([2.0 + STEP_S, 2.0 + 2 * STEP_S])
    assert served.tended == served.robot.read_at
    assert server.slipped_s == 0.0


def test_a_clock_that_is_a_little_late_catches_up_and_one_that_is_later_slips(served):
    server, wall = served.server, served.wall
    wall.now_s += 0.99 * SLIP_S
    server._live()
    assert server.slipped_s == 0.0
    wall.now_s += 0.5
    server._live()
    late_s = 0.99 * SLIP_S + 0.5 - STEP_S
    assert server.slipped_s == pytest.approx(late_s - STEP_S)
    server._live()  # it does not catch up on what has slipped
    assert len(served.robot.read_at) == 2
    wall.now_s += 0.3
    server._live()
    assert server.slipped_s == pytest.approx(late_s - STEP_S + 0.3 - STEP_S)


def test_an_executive_that_lives_gets_what_was_measured_and_supervisors_the_status(served):
    server, wall = served.server, served.wall
    executive, supervisor = Guest(), Guest()
    server._supervisors = [supervisor]
    served.robot.speed = 0.5
    wall.now_s += STEP_S * 1.001
    server._live()
    (status,) = supervisor.posted
    assert status.kind is Kind.STATUS
    assert status.head == {
        "time_s": round(2.0 + STEP_S, 6),
        "latched": "",
        "at_rest": False,
        "speed": 0.5,
        "silent_s": None,
        "slipped_s": 0.0,
        "behind_s": 0.25,
    }
    server._executive, server._is_driven, server._heard_s = executive, True, wall.now_s
    served.robot.speed = 0.019
    wall.now_s += STEP_S
    server._live()
    assert len(supervisor.posted) == 1  # not yet again
    (frame,) = executive.posted
    assert (frame.kind, frame.head["at_rest"]) == (Kind.OBSERVATIONS, True)
    assert frame.head["silent_s"] == pytest.approx(STEP_S)
    wall.now_s += STATUS_S
    server._live()
    assert len(supervisor.posted) == 2
    wall.now_s += 0.31
    server._live()
    assert len(executive.posted) == 2  # it is silent: nothing is sent to it any more


def test_a_silent_executive_stops_the_machine_once_it_has_given_a_sign(served):
    server, wall = served.server, served.wall
    server._notice_silence()
    server._executive, server._heard_s = Guest(), wall.now_s
    wall.now_s += 1.0
    server._notice_silence()
    assert served.robot.stopped == []  # it has not begun to drive
    server._is_driven, server._heard_s = True, wall.now_s - 0.29
    server._notice_silence()
    assert served.robot.stopped == []
    wall.now_s += 0.03
    server._notice_silence()
    server._notice_silence()
    assert served.robot.stopped == ["the executive was silent for 0.32 s"]


def test_an_executive_whose_connection_has_ended_stops_the_machine(served):
    server = served.server
    server._executive, server._heard_s = Guest(), served.wall.now_s
    server._executive.is_open = False
    server._notice_silence()
    assert served.robot.stopped == ["the executive's connection ended"]


def test_it_knows_how_long_nobody_has_driven_it(served):
    server, wall = served.server, served.wall
    wall.now_s += 7.0
    assert server.alone_s == pytest.approx(7.0)
    server._executive = Guest()
    assert server.alone_s == 0.0


def test_another_role_is_refused_with_the_number_of_its_frame(served):
    guest = Guest()
    served.server._greet(guest, Frame(Kind.HELLO, {"role": "owner", "model": "m545"}, sequence=9))
    (refused,) = guest.posted
    assert (refused.kind, refused.sequence) == (Kind.REFUSED, 9)
    assert refused.head == {"reason": "the role is executive or supervisor, not 'owner'"}
    assert served.server._executive is None


@pytest.mark.parametrize(
    ("kind", "asked"),
    [(Kind.STOP, ("stop",)), (Kind.RESUME, ("resume",)), (Kind.RESET, ("reset",)),
     (Kind.PAUSED, ("paused", 2.0)), (Kind.RESUMED, ("resumed", 2.0))],
)  # fmt: skip
def test_what_an_executive_sends_is_done(served, kind, asked):
    served.server._act(Frame(kind))
    assert served.robot.asked == [asked]


def test_what_no_executive_sends_is_an_error(served):
    with pytest.raises(RobotError, match="WELCOME is nothing that an executive sends"):
        served.server._act(Frame(Kind.WELCOME))
