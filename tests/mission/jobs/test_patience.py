"""How long the answer of a verb is awaited, on clocks that the test sets."""

import signal
import time
from collections.abc import Iterator

import pytest

from executive.mission.jobs import patience
from executive.mission.jobs.alarm import Overdue, alarm
from executive.mission.jobs.patience import Patience


class Computer:
    """Its clock on the wall, and for how long one call has had a core, or waited for one [s]."""

    def __init__(self) -> None:
        self.wall_s = self.spent_s = self.ready_s = 0.0

    def compute(self, wall_s: float, share: float, ready: float = 0.0) -> None:
        self.wall_s += wall_s
        self.spent_s += share * wall_s
        self.ready_s += ready * wall_s


@pytest.fixture
def computer(monkeypatch: pytest.MonkeyPatch) -> Computer:
    made = Computer()
    monkeypatch.setattr(patience, "wall_s", lambda: made.wall_s)
    return made


def test_on_the_wall_clock_the_limit_is_a_time(computer: Computer) -> None:
    waited = Patience(30.0)
    computer.compute(30.0, 0.1)
    assert waited.more_s() == 0.0


def test_a_call_on_a_busy_computer_is_awaited_until_it_has_computed_for_its_limit(
    computer: Computer,
) -> None:
    waited = Patience(30.0, lambda: computer.spent_s)
    wait_s, looks = 30.0, 0
    while wait_s:
        computer.compute(wait_s, 0.2)
        wait_s, looks = waited.more_s(), looks + 1
    assert 30.0 <= computer.spent_s <= 31.0
    assert computer.wall_s == pytest.approx(150.0, rel=0.05)
    assert looks < 40


def test_it_tells_each_time_for_how_much_longer_a_call_is_awaited(computer: Computer) -> None:
    granted: list[float] = []
    waited = Patience(30.0, lambda: computer.spent_s, granted=granted.append)
    computer.compute(30.0, 0.2)
    assert waited.more_s() == 24.0
    computer.compute(24.0, 1.0)
    assert waited.more_s() == 0.0
    assert granted == [24.0]


def test_a_call_that_does_not_compute_is_overdue_at_once(computer: Computer) -> None:
    waited = Patience(30.0, lambda: computer.spent_s)
    computer.compute(30.0, 0.01)  # it sleeps, and wakes now and then
    assert waited.more_s() == 0.0


def test_a_call_that_waits_for_a_core_is_not_idle(computer: Computer) -> None:
    """Other processes go first; they had the cores for a minute."""
    waited = Patience(30.0, lambda: computer.spent_s, lambda: computer.ready_s)
    for _ in range(2):
        computer.compute(30.0, 0.01, ready=0.99)
        wait_s = waited.more_s()
        assert 29.0 < wait_s < 30.0
    computer.compute(wait_s, 0.01, ready=0.01)
    assert waited.more_s() == 0.0


def test_a_call_that_stops_computing_is_overdue_at_the_next_look(computer: Computer) -> None:
    waited = Patience(30.0, lambda: computer.spent_s)
    computer.compute(30.0, 0.5)
    wait_s = waited.more_s()
    assert wait_s == pytest.approx(15.0)
    computer.compute(wait_s, 0.0)
    assert waited.more_s() == 0.0


def test_time_in_which_this_process_was_stopped_does_not_count(computer: Computer) -> None:
    waited = Patience(30.0, lambda: computer.spent_s)
    computer.compute(10.0, 0.9)
    computer.compute(3600.0, 0.0)  # Ctrl-Z: call and mission alike
    wait_s = waited.more_s()
    assert wait_s == pytest.approx(21.0)
    computer.compute(wait_s, 0.0)  # now the call alone does not compute
    assert waited.more_s() == 0.0


def test_it_says_what_an_overdue_call_has_failed_to_do(computer: Computer) -> None:
    for share, told in ((1.0, " of computing"), (0.0, "it does not compute")):
        waited = Patience(30.0, lambda: computer.spent_s)
        computer.compute(30.0, share)
        assert waited.more_s() == 0.0
        assert told in waited.told()
    assert Patience(30.0).told() == "no answer within 30 s"


def test_the_alarm_rings_again_when_a_call_has_computed_enough() -> None:
    spent = iter([0.0, 0.05, 0.2])  # at the begin, at the limit, and at the second look
    with pytest.raises(Overdue), alarm(Patience(0.1, lambda: next(spent))):
        time.sleep(1.0)
    assert next(spent, None) is None


def test_the_alarm_ends_a_call_that_hangs() -> None:
    with pytest.raises(Overdue), alarm(Patience(0.05, time.process_time)):
        time.sleep(1.0)


@pytest.fixture
def rings() -> Iterator[list[float]]:
    """When the timer of somebody else has rung [s]; it runs no longer after the test."""
    rung: list[float] = []
    handler = signal.signal(signal.SIGALRM, lambda *_: rung.append(time.monotonic()))
    timer = signal.setitimer(signal.ITIMER_REAL, 0.0)
    yield rung
    signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, *timer)


def test_a_timer_that_runs_already_counts_the_time_of_the_block(rings: list[float]) -> None:
    signal.setitimer(signal.ITIMER_REAL, 0.1)
    with alarm(Patience(10.0)):
        time.sleep(0.2)
        assert not rings
    time.sleep(0.05)
    assert len(rings) == 1


def test_a_timer_rings_at_its_time_after_the_block(rings: list[float]) -> None:
    begun_s = time.monotonic()
    signal.setitimer(signal.ITIMER_REAL, 1.2)
    with alarm(Patience(10.0)):
        time.sleep(1.0)
    while not rings:
        assert time.monotonic() - begun_s < 10.0
        time.sleep(0.005)
    assert 1.19 < rings[0] - begun_s < 2.0


def test_without_a_timer_before_it_none_runs_after_the_block(rings: list[float]) -> None:
    with alarm(Patience(0.05)):
        pass
    time.sleep(0.1)
    assert not rings
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
