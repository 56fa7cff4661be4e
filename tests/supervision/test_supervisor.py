"""The supervisor stops the machine of a silent executive, and ends an executive that hangs."""

import signal

import pytest

from executive.supervision import supervisor as module
from executive.supervision.supervisor import Supervisor

CHILD = 4242


class Time:
    def __init__(self):
        self.now_s = 100.0

    def monotonic(self):
        return self.now_s

    def sleep(self, seconds):
        self.now_s += seconds


class Beacon:
    """What the executive last said of itself."""

    def __init__(self):
        self.silent, self.age, self.overdue = 0.0, 0.0, 0.0
        self.computing, self.ended, self.since_s = False, None, []
        self.is_forgotten = False

    def text(self, name):
        return f"its {name}"

    def silent_s(self, since_s):
        self.since_s.append(since_s)
        return self.silent

    def joints_age_s(self, since_s):
        return self.age

    def overdue_s(self):
        return self.overdue

    def is_computing(self):
        return self.computing

    def status(self):
        return self.ended

    def forget(self):
        self.is_forgotten = True


class Link:
    def __init__(self):
        self.kept, self.stops, self.is_connected = [], [], True

    def keep(self, address):
        self.kept.append(address)

    def stop(self, reason):
        self.stops.append(reason)
        return self.is_connected

    def close(self):
        pass


class Watch:
    def __init__(self, monkeypatch):
        self.time, self.beacon, self.link = Time(), Beacon(), Link()
        self.killed, self.said = [], []
        monkeypatch.setattr(module, "time", self.time)
        monkeypatch.setattr(module, "MachineLink", lambda: self.link)
        monkeypatch.setattr(module.os, "kill", lambda *words: self.killed.append(words))
        self.supervisor = Supervisor(CHILD, self.beacon, self.said.append)

    def look(self, seconds=0.01):
        """Look every hundredth of a second for so long."""
        for _ in range(round(seconds / 0.01)):
            self.time.now_s += 0.01
            self.supervisor._look()


@pytest.fixture
def watch(monkeypatch):
    return Watch(monkeypatch)


HUNG = [(CHILD, signal.SIGUSR2), (CHILD, signal.SIGKILL)]


def test_an_executive_that_lives_is_left_alone(watch):
    watch.look(30.0)
    assert (watch.link.stops, watch.killed, watch.said) == ([], [], [])
    assert watch.link.kept[-1] == "its machine"


@pytest.mark.parametrize(
    ("silent", "age", "told"),
    [(0.52, 0.0, "the executive's loop has been silent for 0.52 s"),
     (0.0, 0.71, "the newest joint sample is 0.71 s old"),
     (0.52, 0.71, "the executive's loop has been silent for 0.52 s")],
)  # fmt: skip
def test_the_machine_is_stopped_once_a_silence(watch, silent, age, told):
    watch.beacon.silent, watch.beacon.age = silent, age
    watch.look(1.0)
    assert watch.link.stops == [f"supervisor: {told}"]
    assert watch.said == [f"supervisor: {told}; the machine was told to stop"]
    watch.beacon.silent = watch.beacon.age = 0.0
    watch.look()
    watch.beacon.silent = 0.3
    watch.look()
    assert len(watch.link.stops) == 2


def test_a_machine_that_cannot_be_told_is_said(watch):
    watch.link.is_connected = False
    watch.beacon.silent = 0.5
    watch.look()
    assert watch.said[0].endswith("no machine in another process is connected that could be "
                                  "told to stop")  # fmt: skip


def test_a_loop_that_stays_silent_for_ten_seconds_is_ended_with_its_stack(watch):
    watch.beacon.silent = 0.5
    watch.look(9.9)
    assert watch.killed == []
    watch.look(0.2)
    assert watch.killed[:2] == HUNG
    assert watch.beacon.is_forgotten
    assert watch.supervisor.reason == "the executive's loop has been silent for 0.50 s"


def test_a_silence_that_ended_does_not_count_for_the_next(watch):
    for _ in range(3):
        watch.beacon.silent = 0.5
        watch.look(6.0)
        watch.beacon.silent = 0.0
        watch.look(0.1)
    assert watch.killed == []


def test_a_verb_that_computes_may_be_silent_until_it_is_overdue(watch):
    watch.beacon.silent, watch.beacon.computing = 0.5, True
    watch.look(20.0)
    watch.beacon.overdue = 2.0
    watch.look()
    assert watch.killed == []
    watch.beacon.overdue = 2.01
    watch.look()
    assert watch.killed == HUNG
    assert watch.supervisor.reason.startswith("it did not end in time")


def test_a_run_that_is_over_has_fifteen_seconds_to_exit(watch):
    watch.beacon.ended = 0
    watch.look(15.0)
    assert watch.killed == []
    watch.look(0.05)
    assert set(watch.killed) == {(CHILD, signal.SIGKILL)}


def test_after_the_whole_computer_was_held_up_the_loop_gets_its_time_anew(watch):
    watch.look(0.1)
    began_s = watch.beacon.since_s[-1]
    assert began_s == 100.0
    watch.time.now_s += 0.08  # within what a busy computer takes
    watch.look()
    assert watch.beacon.since_s[-1] == began_s
    watch.time.now_s += 0.11
    watch.look()
    assert watch.beacon.since_s[-1] == pytest.approx(watch.time.now_s)


def info(number, code):
    return type("Info", (), {"si_signo": number, "si_code": code})()


@pytest.mark.parametrize(
    ("number", "code", "is_forwarded"),
    [(signal.SIGTERM, 0, True), (signal.SIGHUP, 0, True), (signal.SIGUSR1, 0, True),
     (signal.SIGINT, 0, True), (signal.SIGINT, 128, False), (signal.SIGCHLD, 1, False),
     (signal.SIGCHLD, 0, False)],
)  # fmt: skip
def test_signals_of_people_reach_the_executive_once(watch, number, code, is_forwarded):
    watch.supervisor._forward(info(number, code))
    assert watch.killed == ([(CHILD, number)] if is_forwarded else [])


class Children:
    """Processes and signals of the operating system, as a list of looks at them says."""

    def __init__(self, monkeypatch, *looks):
        self._looks = list(looks)
        monkeypatch.setattr(module.signal, "sigtimedwait", self._signal)
        monkeypatch.setattr(module.os, "waitpid", self._waitpid)

    def _signal(self, waited, limit_s):
        assert {signal.SIGCHLD, signal.SIGINT, signal.SIGTERM} <= waited
        assert 0 < limit_s < 0.1
        return self._looks[0][0]

    def _waitpid(self, child, options):
        assert (child, options) == (CHILD, module.os.WNOHANG)
        return self._looks.pop(0)[1]


def test_the_watch_goes_on_until_the_child_has_ended(watch, monkeypatch):
    term = info(signal.SIGTERM, 0)
    Children(monkeypatch, (None, (0, 0)), (term, (0, 0)), (None, (CHILD, 5 << 8)))
    watch.beacon.ended = 2  # what the run has noted counts, not how its process ended
    assert watch.supervisor.run() == 2
    assert watch.killed == [(CHILD, signal.SIGTERM)]
    assert len(watch.link.kept) == 2
    assert (watch.said, watch.link.stops) == ([], [])


def test_a_run_that_was_cut_off_is_told_reported_and_its_machine_stopped(watch, monkeypatch):
    reports = []

    class CutOff:
        def __init__(self, beacon, code, stopped):
            assert beacon is watch.beacon
            self.reason = f"ended with {code}{stopped}"

        def write_report(self):
            reports.append(self.reason)

    monkeypatch.setattr(module, "CutOff", CutOff)
    Children(monkeypatch, (None, (CHILD, int(signal.SIGKILL))))
    assert watch.supervisor.run() == 3
    assert watch.link.kept == ["its machine"]
    assert watch.link.stops == ["supervisor: ended with -9"]
    assert watch.said == ["fault: ended with -9"]
    assert reports == ["ended with -9"]
