"""From rows to figures."""

import math

import numpy as np
import pytest

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.row import Row
from executive.errors import ConfigError
from executive.interfaces.metric import Measurement, Share, Values
from executive.mission.report import cpu_s

NAMES_OF_VALUES = (
    *("placement_error", "attempts", "cycle_time", "scan_time", "reach_time", "carry_time"),
    *("realign_time", "plan_time", "database_error_m", "database_error_rad"),
)


def row(number: int, seed: int, level: str, **measurements: Measurement) -> Row:
    return Row(number, seed, {"filter": level}, True, measurements)


def lost(number: int, seed: int, level: str) -> Row:
    return Row(number, seed, {"filter": level}, False, {})


def test_counts_a_run_without_an_answer_as_no_hit_with_the_stones_of_its_seed() -> None:
    rows = [
        row(0, 1, "a", placed=Share(7, 7)),
        row(1, 2, "a", placed=Share(5, 5)),
        lost(2, 1, "b"),
        row(3, 2, "b", placed=Share(5, 5)),
    ]
    a, b = figures_of(rows, ["placed"]).estimates
    assert (a.hits, a.of, a.assumed, a.without_answer) == (12, 12, 0, 0)
    assert (b.hits, b.of, b.assumed, b.without_answer) == (5, 12, 7, 1)


def test_values_have_a_median_and_tails_and_no_limit_where_none_can_be_told() -> None:
    rows = [row(i, i, "a", cycle_time=Values((float(i),))) for i in range(20)]
    (estimate,) = figures_of(rows, ["cycle_time"]).estimates
    median, interval = estimate.statistics["median"]
    assert median == 9.5
    assert (interval.low, interval.high) == (5.0, 14.0)  # ranks 6 and 15 of 20
    assert math.isnan(estimate.statistics["p95"][1].high)


def test_a_bound_is_missed_by_a_figure_that_nothing_was_measured_for() -> None:
    rows = [row(0, 1, "a")]
    (judgement,) = figures_of(rows, [], [Bound("placed", "share", 0.5, is_least=True)]).judgements
    assert not judgement.is_met
    assert math.isnan(judgement.value)


def test_a_bound_is_not_for_the_levels_that_it_excepts() -> None:
    rows = [row(0, 1, "a"), row(1, 1, "b", placed=Share(1, 1))]
    bound = Bound("placed", "share", 0.5, is_least=True, excepted={"filter": "a"})
    (judgement,) = figures_of(rows, ["placed"], [bound]).judgements
    assert judgement.levels == {"filter": "b"}
    assert judgement.is_met


def test_compares_levels_on_the_seeds_that_both_have() -> None:
    rows = [row(i, i, "a", success=Share(1, 1)) for i in range(40)]
    rows += [row(100 + i, i, "b", success=Share(int(i % 2), 1)) for i in range(30)]
    comparison = Comparison("filter", "a", ("success",))
    (difference,) = figures_of(rows, ["success"], (), [comparison]).differences
    assert (difference.pairs, difference.better, difference.worse) == (30, 0, 15)
    assert difference.difference == -0.5
    assert difference.verdict == "worse"


def test_refuses_a_metric_that_is_not_installed() -> None:
    with pytest.raises(ConfigError, match=r"no metric plugin 'plced'\. Did you mean 'placed'"):
        figures_of([], ["plced"])


def test_takes_the_stones_of_a_lost_run_from_its_cell_where_no_other_has_its_seed() -> None:
    rows = [row(0, 1, "a", placed=Share(7, 7)), row(1, 2, "a", placed=Share(5, 5)), lost(2, 3, "a")]
    (estimate,) = figures_of(rows, ["placed"]).estimates
    assert (estimate.hits, estimate.of, estimate.assumed) == (12, 17, 5)


def test_takes_the_stones_of_a_lost_run_from_the_cell_that_is_most_like_its_own() -> None:
    cells = [("scanned", "a", 21), ("generated", "a", 7), ("generated", "b", None)]
    rows = [
        Row(
            number,
            1,
            {"stones": stones, "filter": level},
            of is not None,
            {} if of is None else {"placed": Share(of, of)},
        )
        for number, (stones, level, of) in enumerate(cells)
    ]
    assert [one.of for one in figures_of(rows, ["placed"]).estimates] == [21, 7, 7]


def test_runs_that_are_all_lost_have_a_share_of_nothing_at_all() -> None:
    (estimate,) = figures_of([lost(0, 1, "a"), lost(1, 2, "a")], ["placed"]).estimates
    assert (estimate.hits, estimate.of) == (0, 2)
    assert estimate.statistics["share"][0] == 0.0


def test_a_metric_that_no_run_can_measure_has_no_share() -> None:
    """Such as the truth of a robot that has none: runs that crashed say nothing about it."""
    rows = [row(0, 1, "a", success=Share(1, 1)), lost(1, 2, "a")]
    success, placed = figures_of(rows, ["success", "placed"]).estimates
    assert (success.hits, success.of) == (1, 2)
    assert placed.of == 0
    assert math.isnan(placed.statistics["share"][0])


def test_a_fault_counts_against_the_shares_that_it_could_not_measure() -> None:
    faulted = Row(1, 2, {"filter": "a"}, True, {"success": Share(0, 1)}, is_faulted=True)
    rows = [row(0, 1, "a", success=Share(1, 1), placed=Share(7, 7)), faulted]
    success, placed = figures_of(rows, ["success", "placed"]).estimates
    assert (success.hits, success.of, success.assumed) == (1, 2, 0)
    assert (placed.hits, placed.of, placed.assumed) == (7, 14, 7)
    assert placed.without_answer == 0


def test_a_metric_that_raised_is_counted_and_costs_nothing_else() -> None:
    broken = Row(1, 2, {"filter": "a"}, True, {}, problems={"placed": "KeyError (x.py:3)"})
    (estimate,) = figures_of([row(0, 1, "a", placed=Share(7, 7)), broken], ["placed"]).estimates
    assert (estimate.hits, estimate.of, estimate.measured, estimate.problems) == (7, 7, 1, 1)


def test_equal_rows_give_equal_figures_in_any_order() -> None:
    rows = [row(i, i, "ab"[i % 2], cycle_time=Values((float(i), i / 2))) for i in range(30)]
    comparison = Comparison("filter", "a", ("cycle_time",))
    once = figures_of(rows, ["cycle_time"], (), [comparison])
    assert repr(once) == repr(figures_of(rows[::-1], ["cycle_time"], (), [comparison]))


def test_ten_thousand_runs_with_fifteen_metrics_take_a_few_seconds() -> None:
    shares, values = ("success", "placed", "held", "lifted", "registered"), NAMES_OF_VALUES
    rng = np.random.default_rng(1)
    rows = []
    for number in range(10_000):
        found: dict[str, Measurement] = {name: Share(int(rng.integers(7)), 7) for name in shares}
        found |= {name: Values(tuple(rng.exponential(1.0, 4).tolist())) for name in values}
        rows.append(Row(number, number // 2, {"filter": "ab"[number % 2]}, True, found))
    names = (*shares, *values)
    begun_s = cpu_s()
    figures = figures_of(rows, names, (), [Comparison("filter", "a", names)])
    assert len(figures.estimates) == 30
    assert len(figures.differences) == 15
    assert cpu_s() - begun_s < 5.0
