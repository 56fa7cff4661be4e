"""Verdicts on differences, and judgements of bounds."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.figures import Difference, Judgement
from executive.campaign.figures.row import Row
from executive.interfaces.metric import Measurement, Share, Values


def rows(name: str, base: list[Measurement | None], own: list[Measurement | None]) -> list[Row]:
    """Return runs of the levels `a` and `b` on seeds 0, 1 …; None for one that crashed."""
    made = []
    for level, measured in (("a", base), ("b", own)):
        for seed, one in enumerate(measured):
            found = {} if one is None else {name: one}
            made.append(Row(len(made), seed, {"filter": level}, one is not None, found))
    return made


def compared(
    name: str, base: list[Measurement | None], own: list[Measurement | None], margin: float = 0.05
) -> Difference:
    comparison = Comparison("filter", "a", (name,), margin)
    (found,) = figures_of(rows(name, base, own), [name], (), [comparison]).differences
    return found


def shares(*hits: int, of: int = 1) -> list[Measurement | None]:
    return [Share(one, of) for one in hits]


def values(*numbers: float) -> list[Measurement | None]:
    return [Values((float(one),)) for one in numbers]


def test_a_level_that_succeeds_less_is_worse() -> None:
    found = compared("success", shares(*[1] * 60), shares(*[1] * 48, *[0] * 12))
    assert (found.verdict, found.better, found.worse) == ("worse", 0, 12)
    assert found.p_value == pytest.approx(2 / 2**12)
    assert found.words.startswith("worse: -20 points (")
    assert "on 60 seeds" in found.words


def test_less_is_better_where_the_metric_says_so() -> None:
    found = compared("placement_error", values(*range(10, 40)), values(*range(5, 35)))
    assert (found.verdict, found.better, found.worse) == ("better", 30, 0)
    assert (found.difference, found.interval.low, found.interval.high) == (-5, -5, -5)
    assert found.words.startswith("better: -5 m")


def test_memory_is_told_in_mebibytes() -> None:
    found = compared("peak_memory", values(*[2**30] * 20), values(*[2**30 + 2**28] * 20))
    assert found.words.startswith("worse: +256 MiB (+256 to +256) on 20 seeds")


def test_a_difference_within_the_margin_does_not_matter() -> None:
    found = compared("cycle_time", values(*[100.0] * 20), values(*[101.0] * 20))
    assert found.verdict == "alike"
    assert compared("cycle_time", values(*[100.0] * 20), values(*[110.0] * 20)).verdict == "worse"


def test_too_few_seeds_say_how_many_would_tell() -> None:
    found = compared("success", shares(*[1] * 10), shares(*[1] * 9, 0))
    assert found.verdict == "too_few"
    needed = re.search(r"some (\d+) would probably do", found.words)
    assert needed is not None
    assert 30 < int(needed[1]) < 120


def test_the_number_that_would_tell_does() -> None:
    found = compared("success", shares(*[1] * 10), shares(*[1] * 9, 0))
    needed = int(re.search(r"some (\d+) would", found.words)[1])
    again = compared("success", shares(*[1] * needed), shares(*([1] * 9 + [0]) * (needed // 10)))
    assert again.verdict == "worse"


def test_rare_collisions_are_seen_though_the_median_is_none() -> None:
    some = [1.0 if i % 4 == 0 else 0.0 for i in range(40)]
    found = compared("collisions", values(*[0.0] * 40), values(*some))
    assert found.difference == 0
    assert found.verdict == "worse"
    assert "better on 0 and worse on 10 of 40 seeds" in found.words


def test_a_crash_counts_against_the_level_that_crashed() -> None:
    found = compared("placed", shares(*[7] * 30, of=7), [*shares(*[7] * 15, of=7), *[None] * 15])
    assert (found.verdict, found.pairs, found.worse) == ("worse", 30, 15)
    assert found.difference == -0.5


def test_a_crash_counts_against_the_level_where_less_is_better() -> None:
    base = shares(*[0] * 30, of=5)
    found = compared("false_alarms", base, [*shares(*[0] * 15, of=5), *[None] * 15])
    assert (found.verdict, found.difference) == ("worse", 0.5)


def test_seeds_with_values_of_one_level_only_are_left_out_and_told() -> None:
    found = compared("cycle_time", values(*range(20)), [*values(*range(17)), *[None] * 3])
    assert (found.pairs, found.left_out) == (17, 3)
    assert "3 seeds are left out" in found.words


def test_without_a_common_seed_nothing_is_told() -> None:
    made = [row for row in rows("success", shares(1, 1), shares(1, 1)) if row.number in (0, 3)]
    comparison = Comparison("filter", "a", ("success",))
    (found,) = figures_of(made, [], (), [comparison]).differences
    assert (found.verdict, found.pairs) == ("too_few", 0)
    assert math.isnan(found.difference)
    assert "both have to run on the same seeds" in found.words


def test_compares_within_each_combination_of_the_other_factors() -> None:
    made = [
        Row(number, seed, {"filter": level, "site": site}, True, {"success": Share(1, 1)})
        for number, (seed, level, site) in enumerate(
            (seed, level, site) for site in ("hill", "flat") for level in "abc" for seed in range(3)
        )
    ]
    found = figures_of(made, [], (), [Comparison("filter", "a", ("success",))]).differences
    assert [(one.level, one.others) for one in found] == [
        ("b", {"site": "hill"}),
        ("c", {"site": "hill"}),
        ("b", {"site": "flat"}),
        ("c", {"site": "flat"}),
    ]


@given(
    st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=1, max_size=25),
    st.floats(0.01, 0.5),
)
def test_exchanging_the_levels_exchanges_better_and_worse(
    hits: list[tuple[int, int]], margin: float
) -> None:
    base, own = (shares(*one, of=4) for one in zip(*hits, strict=True))
    found, other = compared("placed", base, own, margin), compared("placed", own, base, margin)
    exchanged = {"better": "worse", "worse": "better"}
    assert other.verdict == exchanged.get(found.verdict, found.verdict)
    assert (other.better, other.worse) == (found.worse, found.better)


def judged(bound: Bound, *measured: Measurement | None) -> Judgement:
    (found,) = figures_of(rows(bound.metric, list(measured), []), [], [bound]).judgements
    return found


AT_LEAST = Bound("success", "share", 0.9, is_least=True)


@pytest.mark.parametrize(
    ("hits", "runs", "is_met", "is_sure"),
    [(200, 200, True, True), (10, 10, True, False), (8, 10, False, False), (40, 80, False, True)],
)
def test_a_bound_on_a_share_is_met_and_sure_by_its_interval(
    hits: int, runs: int, is_met: bool, is_sure: bool
) -> None:
    found = judged(AT_LEAST, *shares(*[1] * hits, *[0] * (runs - hits)))
    assert (found.is_met, found.is_sure) == (is_met, is_sure)
    assert found.value == hits / runs


def test_a_bound_that_is_reached_exactly_is_met() -> None:
    assert judged(AT_LEAST, *shares(*[1] * 9, 0)).is_met
    assert judged(Bound("cycle_time", "max", 0.3, is_least=False), *values(0.1 + 0.2)).is_met


def test_that_no_value_exceeds_a_bound_is_never_sure_and_that_one_does_is() -> None:
    bound = Bound("placement_error", "max", 1.0, is_least=False)
    within, beyond = judged(bound, *values(*[0.5] * 90)), judged(bound, *values(0.5, 1.5))
    assert (within.is_met, within.is_sure) == (True, False)
    assert (beyond.is_met, beyond.is_sure) == (False, True)


def test_a_bound_holds_in_every_cell_that_it_is_for() -> None:
    made = rows("success", shares(1, 1), shares(0, 0))
    every = figures_of(made, [], [AT_LEAST]).judgements
    assert [(one.levels["filter"], one.is_met) for one in every] == [("a", True), ("b", False)]
    only = Bound("success", "share", 0.9, is_least=True, where={"filter": "b"})
    assert [one.levels["filter"] for one in figures_of(made, [], [only]).judgements] == ["b"]
