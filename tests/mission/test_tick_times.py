"""The time of a tick is charged to the innermost step, and to the node around it."""

import contextlib

import pytest

from executive.mission import tick_times
from executive.mission.tick_times import Share, TickTimes, step_of


@pytest.fixture
def passed(monkeypatch):
    """Let time pass by hand: wall time and processor time [s]."""
    now = [100.0, 5.0]

    def passed(wall_s, thread_s=0.0):
        now[0] += wall_s
        now[1] += thread_s

    monkeypatch.setattr(tick_times, "wall_s", lambda: now[0])
    monkeypatch.setattr(tick_times, "thread_s", lambda: now[1])
    return passed


def test_time_belongs_to_the_innermost_step(passed):
    times = TickTimes()
    passed(3.0)  # before the tick
    times.start()
    passed(0.25)
    with times.spent("streams"):
        passed(0.5, 0.25)
        with times.spent("estimation.add_imu"):
            passed(2.0, 0.125)
        passed(0.5, 0.25)
    shares = times.shares()
    assert [(one.step, one.took_s, one.computed_s) for one in shares] == [
        ("estimation.add_imu", 2.0, 0.125),
        ("streams", 1.0, 0.5),
        ("loop", 0.25, 0.0),
    ]
    times.start()
    passed(0.125)
    assert times.shares() == (Share("loop", "", 0.125, 0.0),)


def test_a_step_within_a_leaf_names_its_node(passed):
    times = TickTimes()
    with times.spent("leaf", "main/0:Swing"):
        passed(1.0)
        with times.spent("journal"):
            passed(2.0)
    found = {(one.step, one.node): one.took_s for one in times.shares()}
    assert found[("leaf", "main/0:Swing")] == 1.0
    assert found[("journal", "main/0:Swing")] == 2.0


def test_an_error_ends_the_steps_that_it_leaves(passed):
    times = TickTimes()
    with contextlib.suppress(ValueError), times.spent("tree"), times.spent("leaf", "main"):
        raise ValueError
    times.start()
    passed(1.0)
    assert times.shares() == (Share("loop", "", 1.0, 0.0),)


def test_in_lock_step_no_clock_is_read(monkeypatch):
    times = TickTimes(measures=False)
    monkeypatch.delattr(tick_times, "thread_s")
    with times.spent("tree"), times.spent("leaf", "main"):
        pass
    assert times.shares() == ()


def test_a_verb_is_named_by_the_capability_of_its_plugin():
    class Plain:
        def run(self):
            """Do nothing."""

    class Mapping(Plain):
        capability = "mapping"

    assert step_of(Mapping().run) == "mapping.run"
    assert step_of(Plain().run) == "run"
