"""A window of samples and fixes by hand: what it waits for, and which clock it believes."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.start import window_start
from executive_plugins.estimation.start.settings import WindowStartSettings
from executive_plugins.estimation.start.window_start import WindowStart, _Trial

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
UP = np.array([0.0, 0.0, 9.81])
Z = np.zeros(3)


def window(clock_std_s: float = 0.0, **settings: object) -> WindowStart:
    return WindowStart(WindowStartSettings(**settings), NOISE, clock_std_s)


def feed(one: WindowStart, begin_s: float, end_s: float, fixes: bool = False) -> None:
    """Add samples every 10 ms, and fixes every 0.2 s if there are any."""
    for k in range(round(100 * begin_s), round(100 * end_s)):
        one.add_sample(Inertial(k / 100, Z, UP, 0.01))
        if fixes and k % 20 == 0:
            one.add_fix(Fix(k / 100, "left", Z, Z, 1e-4 * np.eye(3)))


def answered(one: WindowStart, trials: dict[float, Any]) -> list[float]:
    """Let the solutions for clocks be made up; return the clocks that were asked for."""
    asked: list[float] = []

    def solved_at(late_s: float) -> Any:
        asked.append(round(late_s, 6))
        yield
        return trials.get(round(late_s, 6))

    one._solved_at = solved_at
    return asked


def trial(late_s: float, cost: float, scatter: float = 1.0) -> Any:
    return SimpleNamespace(
        late_s=late_s, cost=cost, scatter=scatter, solutions=[], hypotheses=[late_s], nodes=[]
    )


def finished(one: WindowStart, judge: Callable[..., Any]) -> Any:
    one._judged = judge
    steps = one._steps()
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def test_without_fixes_in_the_window_it_waits_for_fixes() -> None:
    one = window(window_s=4.0)
    feed(one, 0.0, 1.0)
    assert one.state() is None
    assert one.waits_for == "fixes"
    one.waits_for = ""
    one.add_fix(Fix(0.5, "left", Z, Z, np.eye(3)))
    assert one.state() is None
    assert one.waits_for == ""  # there is one, and it is not enough to begin
    feed(one, 1.0, 4.4)
    assert one.state() is None
    assert one.waits_for == ""
    feed(one, 4.4, 4.6)
    assert one.state() is None
    assert one.waits_for == "fixes"  # it is older than the window


def test_a_fix_that_is_older_than_the_samples_is_left_out() -> None:
    one = window()
    one.add_fix(Fix(0.5, "left", Z, Z, np.eye(3)))
    feed(one, 1.0, 1.1)
    one.add_fix(Fix(0.5, "left", Z, Z, np.eye(3)))
    assert one.state() is None
    assert one.waits_for == "fixes"


def test_too_few_times_of_fixes_are_told() -> None:
    one = window()
    answered(one, {})
    assert finished(one, lambda *given: "judged") is None
    assert one.waits_for == "fixes: fewer than two times so far"


def test_other_clocks_are_at_either_side_and_none_of_them_is_the_present_one() -> None:
    one = window(clock_std_s=0.1)
    low, high = one._other_clocks()
    assert low == -high
    assert high > 0.1
    one._late_s = high - 0.049
    assert one._other_clocks() == [low, 0.0]
    one._late_s = high - 0.051
    assert one._other_clocks() == [low, 0.0, high]
    one._late_s = 0.02
    assert one._other_clocks() == [low, high]


@pytest.mark.parametrize(("other_cost", "believed"), [(3.0, "low"), (9.0, "present")])
def test_bad_fixes_may_be_those_of_another_clock(other_cost: float, believed: str) -> None:
    one = window(clock_std_s=0.1)
    low, high = one._other_clocks()
    trials = {0.0: trial(0.0, 5.0, scatter=2.0), round(low, 6): trial(low, other_cost)}
    asked = answered(one, trials)
    expected = low if believed == "low" else 0.0
    judged = finished(one, lambda hypotheses, held, nodes: (hypotheses, held, nodes))
    assert judged == ([expected], [], [])
    assert asked == [0.0, round(low, 6), round(high, 6)]
    assert one._late_s == expected


def test_good_fixes_need_no_other_clock() -> None:
    one = window(clock_std_s=0.1)
    asked = answered(one, {0.0: trial(0.0, 5.0, scatter=1.5)})
    assert finished(one, lambda *given: "judged") == "judged"
    assert asked == [0.0]


def test_fixes_that_no_motion_explains_are_told() -> None:
    one = window()
    assert one._judged([], [], []) is None
    assert one.waits_for == "fixes that fit the inertial samples"


def test_an_attempt_without_solutions_costs_more_than_any_other() -> None:
    none = _Trial(0.0, [], SimpleNamespace(), [], [])
    assert (none.cost, none.scatter) == (np.inf, 1.0)
    some = [SimpleNamespace(cost=cost, fix_scale=scale) for cost, scale in ((4.0, 2.0), (3.0, 5.0))]
    found = _Trial(0.0, [], SimpleNamespace(), some, some)
    assert (found.cost, found.scatter) == (3.0, 5.0)


@pytest.mark.parametrize(("fixes", "is_solved"), [(1, False), (2, True)])
def test_a_window_is_solved_from_two_times_of_fixes_on(fixes: int, is_solved: bool) -> None:
    one = window()
    feed(one, 0.0, 2.0)
    for k in range(fixes):
        for name, arm in (("left", [0.0, 1.0, 0.0]), ("right", [0.0, -1.0, 0.0])):
            place = np.array(arm)
            one.add_fix(Fix(0.5 + k, name, place, place, 1e-4 * np.eye(3)))
    steps = one._solved_at(0.0)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            solved = end.value
            break
    assert (solved is not None) is is_solved
    if is_solved:
        assert len(solved.solutions) == len(solved.hypotheses) > 0
        assert solved.cost == pytest.approx(0.0, abs=1e-3)  # antennas at rest, where they are


@pytest.mark.parametrize(
    ("scale", "moved_s", "clock_std_s", "again"),
    [
        (1.5, 0.0, 0.0, False),
        (1.7, 0.0, 0.0, True),  # fixes scatter more than 1.6 times what was assumed
        (1.0, 0.5, 0.1, True),  # the clock has moved by more than a line through the fixes
        (1.0, 0.0, 0.1, False),
        (1.0, 0.5, 0.0, False),  # clocks that agree do not move
    ],
)
def test_a_problem_with_another_clock_or_accuracy_is_solved_again(
    monkeypatch: pytest.MonkeyPatch, scale: float, moved_s: float, clock_std_s: float, again: bool
) -> None:
    state = SimpleNamespace(gyro_bias=np.full(3, 0.01))
    found = SimpleNamespace(
        state=state, fix_scale=scale, has_heading=True, clock=SimpleNamespace(offset_s=moved_s)
    )
    monkeypatch.setattr(window_start, "most_likely", lambda *given: (found, 1, 0.1))
    one = window(clock_std_s)
    one._tried_s, one._next_span_s = 3.0, 2.0
    nodes = [(0.0, [Fix(0.0, "left", Z, Z, 1e-4 * np.eye(3))])]
    answer = one._judged([found], [], nodes)
    assert (answer is None) is again
    assert one.waits_for == ("the receiver's clock and accuracy" if again else "")
    assert (one._tried_s, one._next_span_s) == ((-np.inf, 0.0) if again else (3.0, 2.0))
    assert one._late_s == moved_s
    # The second time the same answer is what was assumed.
    assert one._judged([found], [], nodes) is found
