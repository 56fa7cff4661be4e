"""Intervals of quantiles: ranks, open ends, and properties."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from executive.campaign.figures.intervals.quantile import quantile_interval

VALUES = st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=60)


def alone(values: list[float]) -> np.ndarray:
    """Return sites of values that have one each."""
    return np.arange(len(values), dtype=float)


@pytest.mark.parametrize(
    ("number", "probability", "low", "high"),
    [
        # as tables of the sign test have them
        (6, 0.5, 1, 6),
        (10, 0.5, 2, 9),
        (20, 0.5, 6, 15),
        (100, 0.5, 40, 61),
        (100, 0.9, 84, 96),
    ],
)
def test_the_ends_are_values_of_known_ranks(
    number: int, probability: float, low: int, high: int
) -> None:
    values = np.arange(1.0, number + 1)
    interval = quantile_interval(values, alone(values), probability)
    assert (interval.low, interval.high) == (low, high)
    inside = stats.binom.cdf(high - 1, number, probability) - stats.binom.cdf(
        low - 1, number, probability
    )
    assert inside >= 0.95


def test_an_end_that_few_values_do_not_bound_is_left_open() -> None:
    values = np.arange(20.0)
    interval = quantile_interval(values, alone(values), 0.95)
    assert interval.low == 16.0
    assert math.isnan(interval.high)
    assert math.isnan(quantile_interval(values[:5], alone(values[:5]), 0.5).low)
    assert math.isnan(quantile_interval(values[:1], alone(values[:1]), 0.5).low)


def test_values_of_one_site_that_are_alike_count_about_once() -> None:
    values = np.repeat(np.arange(30.0), 7)
    sites = np.repeat(np.arange(30.0), 7)
    together = quantile_interval(values, sites, 0.5)
    once = quantile_interval(np.arange(30.0), np.arange(30.0), 0.5)
    assert together.low == pytest.approx(once.low, abs=1)
    assert together.high == pytest.approx(once.high, abs=1)


@given(VALUES, st.sampled_from([0.5, 0.9, 0.95]))
def test_the_interval_holds_the_quantile_and_its_ends_are_measured(
    values: list[float], probability: float
) -> None:
    interval = quantile_interval(np.array(values), alone(values), probability)
    at = np.quantile(values, probability)
    room = 1e-6 * max(1.0, abs(at))
    assert math.isnan(interval.low) or (interval.low <= at + room and interval.low in values)
    assert math.isnan(interval.high) or (at - room <= interval.high and interval.high in values)


@given(VALUES)
def test_a_monotone_scale_changes_nothing_but_the_scale(values: list[float]) -> None:
    plain = quantile_interval(np.array(values), alone(values), 0.5)
    scaled = quantile_interval(2 * np.array(values) + 1, alone(values), 0.5)
    expected = [2 * end + 1 for end in (plain.low, plain.high)]
    assert [scaled.low, scaled.high] == pytest.approx(expected, nan_ok=True)
