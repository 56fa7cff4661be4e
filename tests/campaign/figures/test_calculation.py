"""From rows to figures."""

import math

import pytest

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.row import Row
from executive.errors import ConfigError
from executive.interfaces.metric import Measurement, Share, Values


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
