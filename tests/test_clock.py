"""The two clocks: lock-step and wall."""

import pytest

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
