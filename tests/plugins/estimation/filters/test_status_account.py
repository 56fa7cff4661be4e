"""A filter says why its status changes, and a single fix that chance explains changes nothing."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from executive.messages.gnss import GnssFix
from executive.messages.observation import Observation

UP_3_M = np.array([0.0, 0.0, 3.0])


def account(
    cabin, estimator, lasts_s: float, change: Callable[[GnssFix], Observation | None]
) -> list[tuple[str, str, str]]:
    """Feed a drive whose fixes are changed, or left out; return status, status and reason."""
    for observation in cabin.observations(lasts_s):
        fed = change(observation) if isinstance(observation, GnssFix) else observation
        if fed is not None:
            estimator.add(fed)
            estimator.state()
    return [(one.before, one.after, one.reason) for one in estimator.account()]


def moved(fix: GnssFix, from_s: float, until_s: float) -> GnssFix:
    is_moved = from_s < fix.stamp_s < until_s
    return replace(fix, geodetic=fix.geodetic + UP_3_M) if is_moved else fix


def test_it_names_the_fix_that_it_refused_and_how_the_doubt_ended(cabin, estimator) -> None:
    changes = account(cabin, estimator, 28.0, lambda fix: moved(fix, 4.0, 99.0))
    assert [change[1] for change in changes] == [
        "GLOBAL", "SUSPECT", "FALLBACK", "SUSPECT", "GLOBAL"
    ]  # fmt: skip
    found, refused, silent, _, anew = [change[2] for change in changes]
    assert found == "the first state with a heading was found"
    assert re.fullmatch(r"two fixes were refused, that of gnss_\w+ by (2\.9|3\.0)\d m", refused)
    assert silent.startswith("no fix was used for 1.0")
    assert anew.startswith("begun anew from the fixes that were refused")


def test_it_says_for_how_long_no_fix_was_used(cabin, estimator) -> None:
    def silent(fix: GnssFix) -> GnssFix | None:
        return None if 6.0 < fix.stamp_s < 8.5 else fix

    changes = account(cabin, estimator, 10.0, silent)
    assert changes[-2:] == [
        ("GLOBAL", "FALLBACK", "no fix was used for 1.0 s"),
        ("FALLBACK", "GLOBAL", "fixes agree with it again"),
    ]


def wrong_by_chance(antenna: str, count: int) -> Callable[[GnssFix], GnssFix]:
    """Return what moves the first fixes of an antenna after 8 s by 8 cm: eight deviations."""
    seen: list[float] = []

    def change(fix: GnssFix) -> GnssFix:
        if fix.antenna != antenna or fix.stamp_s < 8.0 or len(seen) >= count:
            return fix
        seen.append(fix.stamp_s)
        return replace(fix, geodetic=fix.geodetic + np.array([0.0, 0.0, 0.08]))

    return change


def test_one_refused_fix_that_chance_explains_is_no_reason_to_doubt_the_state(
    cabin, estimator
) -> None:
    changes = account(cabin, estimator, 12.0, wrong_by_chance("gnss_left", 1))
    assert estimator.refused == {"gnss_left: outlier": 1}
    assert [change[1] for change in changes] == ["GLOBAL"]


def test_two_refused_fixes_of_three_are(cabin, estimator) -> None:
    changes = account(cabin, estimator, 12.0, wrong_by_chance("gnss_left", 2))
    assert estimator.refused == {"gnss_left: outlier": 2}
    assert [change[1] for change in changes] == ["GLOBAL", "SUSPECT"]
