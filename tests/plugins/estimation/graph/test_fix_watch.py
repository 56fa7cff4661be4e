"""After which time fixes are missing, and for how long a drift of odometry adds up."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.gnss_gate import Compared
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.fix_watch import FixWatch
from executive_plugins.estimation.graph.settings import SmootherSettings

Z = np.zeros(3)


def watched(period_s: float, off_m: float = 0.0, count: int = 10) -> FixWatch:
    """Return a watch that has seen fixes that are off by some deviations of 1 m."""
    watch = FixWatch(SmootherSettings(), 0.0)
    for k in range(1, count + 1):
        fix = Fix(k * period_s, "left", Z, Z, np.eye(3))
        off = np.array([off_m, 0.0, 0.0])
        watch.add(Compared(fix, off, np.eye(3), Z, np.eye(3), False))
    return watch


@pytest.mark.parametrize(
    ("period_s", "suspect_s", "fallback_s"), [(0.1, 0.6, 1.0), (1.0, 1.5, 2.5)]
)
def test_fixes_that_come_seldom_are_not_missing(period_s, suspect_s, fallback_s) -> None:
    watch = watched(period_s)
    assert watch.suspect_after_s == pytest.approx(suspect_s)
    assert watch.fallback_after_s == pytest.approx(fallback_s)
    assert watch.missing_after_s == pytest.approx(2.5 * period_s)


@pytest.mark.parametrize(("count", "suspect_s", "fallback_s"), [(0, 0.6, 1.0), (1, 1.5, 2.5)])
def test_the_second_fix_is_waited_for_as_long_as_the_slowest_receivers_take(
    count, suspect_s, fallback_s
) -> None:
    watch = watched(0.1, count=count)
    assert watch.suspect_after_s == pytest.approx(suspect_s)
    assert watch.fallback_after_s == pytest.approx(fallback_s)


def test_a_drift_adds_up_since_the_last_used_fix_until_fixes_are_missing() -> None:
    watch = watched(1.0)
    watch.use(10.0, 3.0)
    assert watch.drifting_s(11.0) == pytest.approx(1.0)
    assert watch.drifting_s(20.0) == pytest.approx(2.5)


def test_a_late_fix_does_not_set_the_time_of_the_last_used_one_back() -> None:
    watch = watched(1.0)
    watch.use(10.0, 3.0)
    watch.use(9.0, 4.0)
    assert (watch.used_s, watch.used_way_m) == (10.0, 4.0)


@pytest.mark.parametrize(("off_m", "is_told"), [(0.5, False), (4.0, True)])
def test_fixes_that_are_farther_than_chance_explains_contradict(off_m, is_told) -> None:
    assert watched(0.2, off_m).contradicts == is_told
