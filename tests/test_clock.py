"""The two clocks: lock-step and wall."""

import select

import pytest

from executive import clock as clock_module
from executive.clock import SimulatedClock, WallClock, wall_s


def test_a_simulated_tick_is_at_exactly_n_dt() -> None:
    clock = SimulatedClock()
    for n in range(1, 10_001):
        clock.advance(0.05)
        assert clock.now_s() == n * 0.05


def test_a_simulated_mission_begins_at_zero() -> None:
    assert SimulatedClock().now_s() == 0.0


def test_a_lock_step_clock_keeps_its_tick() -> None:
    clock = SimulatedClock()
    clock.advance(0.05)
    with pytest.raises(ValueError, match=r"has ticks of one length: 0.05 s, got 0.1 s"):
        clock.advance(0.1)


def test_the_wall_clock_waits_for_the_tick_and_never_runs_ahead() -> None:
    clock = WallClock()
    for n in range(1, 4):
        clock.advance(0.02)
        assert clock.now_s() >= n * 0.02 - 1e-3


def test_a_late_tick_is_not_made_up_for() -> None:
    clock = WallClock()
    late_s = wall_s() + 0.06
    while wall_s() < late_s:
        pass
    clock.advance(0.02)
    after_s = clock.now_s()
    clock.advance(0.02)
    assert clock.now_s() >= after_s + 0.015  # one tick later, not at once


def test_the_wall_clock_stands_still_while_the_machine_is_behind_and_never_goes_back() -> None:
    clock = WallClock()
    clock.advance(0.02)
    shown_s = clock.machine_s()
    clock.wait_for(0.0)  # the machine says that it is earlier than what was shown already
    assert clock.machine_s() == shown_s
    clock.wait_for(float("inf"))
    clock.advance(0.02)
    assert clock.machine_s() > shown_s + 0.01


def test_ticks_go_on_while_the_wall_clock_stands_still() -> None:
    clock = WallClock()
    began_s = wall_s()
    clock.advance(0.01)
    for _ in range(20):
        clock.wait_for(0.0)
        clock.advance(0.01)
    # If each wait were longer than the one before, twenty would take 20 · 21 / 2 ticks.
    assert 20 * 0.01 <= wall_s() - began_s < 100 * 0.01


class Wall:
    """The computer's monotonic clock, set by hand; a wait on it takes exactly as long as asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_s, self.waits_s, self.is_woken = 1000.0, [], False
        monkeypatch.setattr(clock_module, "time", self)
        monkeypatch.setattr(clock_module, "select", self)

    def monotonic(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.waits_s.append(seconds)

    def select(self, ends: list[int], _write: object, _error: object, seconds: float) -> tuple:
        self.waits_s.append(seconds)
        self.now_s += 0.0 if self.is_woken else seconds
        return (ends if self.is_woken else [],)


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Wall:
    return Wall(monkeypatch)


def test_lock_step_time_stands_still_in_a_pause_and_the_machines_goes_on() -> None:
    clock = SimulatedClock()
    assert clock.stands_at_rest
    times = []
    for tick in range(9):
        if tick in (2, 6):
            clock.pause()
            clock.pause()
        if tick in (4, 7):
            clock.resume()
        assert clock.advance(0.5) == 0.0
        times.append((clock.now_s(), clock.machine_s(), clock.paused_s, clock.is_paused))
    assert times == [
        (0.5, 0.5, 0.0, False), (1.0, 1.0, 0.0, False),
        (1.0, 1.5, 0.5, True), (1.0, 2.0, 1.0, True),
        (1.5, 2.5, 1.0, False), (2.0, 3.0, 1.0, False),
        (2.0, 3.5, 1.5, True), (2.5, 4.0, 1.5, False), (3.0, 4.5, 1.5, False),
    ]  # fmt: skip
    # At the very time of a pause it is the time at which the pause began.
    at = {0.5: 0.5, 1.0: 1.0, 1.25: 2.25, 2.0: 3.0, 2.25: 3.75, 3.0: 4.5}
    assert {mission_s: clock.machine_at(mission_s) for mission_s in at} == at
    clock.resume()  # it goes on already
    assert clock.machine_at(3.0) == 4.5


def test_a_lock_step_mission_that_was_cut_off_goes_on_at_its_times() -> None:
    clock = SimulatedClock()
    clock.go_on_at(41, 0.05, 2.0, 3.5)
    assert (clock.now_s(), clock.machine_s(), clock.paused_s) == (2.0, 3.5, 1.5)
    clock.advance(0.05)
    assert clock.now_s() == pytest.approx(2.05, rel=1e-12)
    with pytest.raises(ValueError, match="ticks of one length"):
        clock.advance(0.1)


def test_a_paused_lock_step_clock_keeps_its_tick_too() -> None:
    clock = SimulatedClock()
    clock.pause()
    clock.advance(0.05)
    with pytest.raises(ValueError, match="ticks of one length"):
        clock.advance(0.1)


def test_a_pause_waits_a_moment_on_the_wall_between_two_looks(wall: Wall) -> None:
    SimulatedClock().idle()
    WallClock().idle()
    assert len(wall.waits_s) == 2
    assert all(0 < seconds <= 0.1 for seconds in wall.waits_s)


def test_a_tick_on_the_wall_ends_at_its_time_and_a_late_one_begins_the_schedule_anew(
    wall: Wall,
) -> None:
    clock = WallClock()
    late_s = []
    for computed_s in (0.125, 0.5, 0.75, 0.0):
        wall.now_s += computed_s
        late_s.append((clock.advance(0.5), clock.now_s()))
    assert late_s == [(0.0, 0.5), (0.0, 1.0), (0.25, 1.75), (0.0, 2.25)]
    assert wall.waits_s == [0.375, 0.5]


def test_a_wall_clock_starts_when_it_is_told(wall: Wall) -> None:
    clock = WallClock()
    clock.advance(0.5)
    wall.now_s += 7.0
    clock.wait_for(2.0)
    clock.start()
    assert (clock.now_s(), clock.machine_s()) == (0.0, 0.0)
    assert clock.advance(0.5) == 0.0
    assert clock.now_s() == 0.5


def test_mission_time_on_the_wall_stands_still_in_a_pause(wall: Wall) -> None:
    clock = WallClock()
    assert not clock.stands_at_rest
    wall.now_s += 2.0
    clock.pause()
    wall.now_s += 1.0
    clock.pause()  # it is paused already
    wall.now_s += 2.0
    assert (clock.now_s(), clock.machine_s(), clock.paused_s) == (2.0, 5.0, 0.0)
    clock.resume()
    clock.resume()
    assert (clock.now_s(), clock.machine_s(), clock.paused_s) == (2.0, 5.0, 3.0)
    wall.now_s += 1.0
    clock.pause()
    wall.now_s += 0.5
    clock.resume()
    assert (clock.now_s(), clock.machine_s(), clock.paused_s) == (3.0, 6.5, 3.5)
    at = {2.0: 2.0, 2.5: 5.5, 3.0: 6.0, 3.25: 6.75}
    assert {mission_s: clock.machine_at(mission_s) for mission_s in at} == at


def test_a_mission_on_the_wall_that_was_cut_off_goes_on_at_its_times(wall: Wall) -> None:
    clock = WallClock()
    wall.now_s += 4.0
    clock.wait_for(1.0)
    clock.go_on_at(41, 0.5, 20.0, 23.0)
    assert (clock.now_s(), clock.machine_s(), clock.paused_s) == (20.0, 23.0, 3.0)
    wall.now_s += 0.125
    assert clock.advance(0.5) == 0.0
    assert (clock.now_s(), clock.machine_s()) == (20.5, 23.5)


def test_the_wall_clock_shows_no_later_time_than_the_machine_can_have(wall: Wall) -> None:
    clock = WallClock()
    wall.now_s += 2.0
    clock.wait_for(1.5)
    assert clock.machine_s() == 1.5
    wall.now_s += 1.0
    assert clock.machine_s() == 2.5
    clock.wait_for(5.0)  # the machine is ahead: the clock is not
    assert clock.machine_s() == 3.0


def test_a_wait_is_ended_by_wakes_which_count_once() -> None:
    clock = WallClock()
    for _ in range(3):
        clock.wake()
    clock._wait(60.0)
    assert select.select([clock._awake], [], [], 0.0)[0] == []


def test_wakes_that_nobody_reads_fill_nothing_that_could_block() -> None:
    clock = WallClock()
    for _ in range(70_000):  # more than a pipe holds
        clock.wake()
    assert select.select([clock._awake], [], [], 0.0)[0] == [clock._awake]
