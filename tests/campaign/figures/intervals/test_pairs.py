"""Intervals of paired differences, against published examples and by their properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.campaign.figures.intervals.pairs import (
    difference_of_shares,
    medians_by_seed,
    sign_test,
)

PAIRS = st.lists(
    st.integers(1, 9).flatmap(
        lambda of: st.tuples(st.integers(0, of), st.integers(0, of), st.just(of))
    ),
    min_size=2,
    max_size=30,
)


def table(both: int, first: int, second: int, neither: int) -> tuple[np.ndarray, np.ndarray]:
    """Return single trials of pairs: hits of the first and of the second."""
    counts = [both, first, second, neither]
    return np.repeat([1.0, 1.0, 0.0, 0.0], counts), np.repeat([1.0, 0.0, 1.0, 0.0], counts)


@pytest.mark.parametrize(
    ("counts", "low", "high"),
    [
        # Fagerland, Lydersen & Laake 2014, Stat. Med. 33, 2850–2875: square-and-add intervals
        ((1, 1, 7, 12), -0.507, -0.026),
        ((59, 6, 16, 80), -0.119, -0.005),
    ],
)
def test_newcombe_s_interval_is_that_of_published_examples(
    counts: tuple[int, int, int, int], low: float, high: float
) -> None:
    first, second = table(*counts)
    ones = np.ones(len(first))
    difference, interval = difference_of_shares(first, ones, second, ones)
    assert difference == pytest.approx((counts[1] - counts[2]) / sum(counts))
    assert (interval.low, interval.high) == pytest.approx((low, high), abs=6e-4)


def test_the_sign_test_is_the_exact_binomial_one() -> None:
    assert sign_test(1, 7) == pytest.approx(2 * (1 + 8) / 2**8)
    assert sign_test(4, 4) == 1.0
    assert sign_test(0, 0) == 1.0


def test_each_seed_counts_with_the_median_of_its_values() -> None:
    seeds, medians = medians_by_seed(
        np.array([2.0, 1.0, 2.0, 2.0, 1.0]), np.array([9.0, 1.0, 3.0, 4.0, 2.0])
    )
    assert seeds.tolist() == [1, 2]
    assert medians.tolist() == [1.5, 4.0]


@given(PAIRS)
def test_the_interval_holds_the_difference_and_turns_with_its_sign(
    pairs: list[tuple[int, int, int]],
) -> None:
    hits, base, of = np.array(pairs, dtype=float).T
    difference, interval = difference_of_shares(hits, of, base, of)
    assert interval.low <= difference + 1e-12
    assert difference - 1e-12 <= interval.high
    turned, other = difference_of_shares(base, of, hits, of)
    assert turned == pytest.approx(-difference, abs=1e-12)
    assert (other.low, other.high) == pytest.approx((-interval.high, -interval.low), abs=1e-9)


@given(PAIRS)
def test_no_difference_is_told_between_a_level_and_itself(
    pairs: list[tuple[int, int, int]],
) -> None:
    hits, _, of = np.array(pairs, dtype=float).T
    difference, interval = difference_of_shares(hits, of, hits, of)
    assert difference == 0
    assert interval.low <= 0 <= interval.high
