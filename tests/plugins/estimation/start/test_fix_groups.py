"""Fixes of a window, thinned: what is said together stays, and a motion is not bent."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.start.fix_groups import grouped, longest_straight_s

Z = np.zeros(3)


def fixes(
    count: int, period_s: float = 0.1, std_m: float = 0.1, antennas: tuple[str, ...] = ("left",)
) -> dict[float, list[Fix]]:
    """Return fixes along x at 1 m/s, those of a second antenna 2 m beside them."""
    P = std_m**2 * np.diag([1.0, 2.0, 3.0])
    return {
        k * period_s: [
            Fix(k * period_s, name, Z, np.array([k * period_s, 2.0 * i, 0.0]), P)
            for i, name in enumerate(antennas)
        ]
        for k in range(count)
    }


@pytest.mark.parametrize("count", [1, 5])
def test_few_times_stay_as_they_are(count: int) -> None:
    given = fixes(count)
    assert grouped(given, 5) == list(given.items())


def test_chosen_times_are_even_and_the_first_and_last_are_among_them() -> None:
    found = grouped(fixes(101, std_m=1e-6), 5)
    assert [at_s for at_s, _ in found] == pytest.approx([0.0, 2.5, 5.0, 7.5, 10.0])
    for at_s, (fix,) in found:
        assert fix.stamp_s == at_s
        assert fix.p_map_antenna[0] == pytest.approx(at_s)


@pytest.mark.parametrize("std_m", [0.02, 0.1, 0.5])
def test_as_many_are_joined_as_the_noise_of_their_mean_outweighs_the_bend(std_m: float) -> None:
    """a T² / 24 = σ / √(T f) for 5 m/s² and 10 Hz."""
    span_s = (24 * std_m * np.sqrt(0.1) / 5.0) ** 0.4
    joined = 2 * int(span_s / 0.2) + 1
    found = grouped(fixes(401, std_m=std_m), 9)
    middle = found[4][1][0]
    assert middle.covariance == pytest.approx(std_m**2 * np.diag([1.0, 2.0, 3.0]) / joined)
    assert middle.p_map_antenna == pytest.approx(np.array([20.0, 0.0, 0.0]))
    for _, (fix,) in (found[0], found[-1]):  # there is nothing on the other side
        assert fix.covariance == pytest.approx(std_m**2 * np.diag([1.0, 2.0, 3.0]))


def test_no_fix_is_in_two_groups() -> None:
    """Of 21 fixes and 5 times, those between are five apart: two on either side at most."""
    found = grouped(fixes(21, std_m=100.0), 5)
    counts = [100.0**2 / fix.covariance[0, 0] for _, (fix,) in found]
    assert counts == pytest.approx([1, 5, 5, 5, 1])


def test_each_antenna_has_its_own_mean_and_one_that_was_blocked_has_none() -> None:
    given = fixes(41, std_m=1.0, antennas=("left", "right"))
    whole = grouped(given, 3)[1][1]
    assert [fix.antenna for fix in whole] == ["left", "right"]
    assert [fix.p_map_antenna[1] for fix in whole] == pytest.approx([0.0, 2.0])
    assert all(fix.covariance[0, 0] < 1.0 for fix in whole)
    stamps = list(given)
    del given[stamps[19]][1]
    left, right = grouped(given, 3)[1][1]
    assert left.covariance[0, 0] < 1.0
    assert right is given[stamps[20]][1]


@pytest.mark.parametrize(("std_m", "expected_s"), [(0.025, 0.1), (0.1, 0.2), (2.5, 1.0)])
def test_a_motion_is_straight_while_it_bends_by_less_than_the_noise(
    std_m: float, expected_s: float
) -> None:
    """σ = a T² / 2 with 5 m/s²; the best known direction counts."""
    fix = Fix(0.0, "left", Z, Z, np.diag([4.0, 1.0, 9.0]) * std_m**2)
    assert longest_straight_s(fix) == pytest.approx(expected_s)
