"""Intervals of shares, against published examples and by their properties."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.campaign.figures.intervals.share import clustered, effective_trials, wilson

# Hits and trials of each site of a campaign.
SITES = st.lists(
    st.integers(1, 9).flatmap(lambda of: st.tuples(st.integers(0, of), st.just(of))),
    min_size=2,
    max_size=30,
)


@pytest.mark.parametrize(
    ("hits", "trials", "low", "high"),
    [
        # Newcombe 1998, Stat. Med. 17, 857–872, Table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0000, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_s_interval_is_that_of_published_examples(
    hits: int, trials: int, low: float, high: float
) -> None:
    interval = wilson(hits / trials, trials)
    assert (interval.low, interval.high) == pytest.approx((low, high), abs=5e-5)


def test_wilson_s_interval_solves_the_score_equation() -> None:
    interval = wilson(0.3, 50)
    for end in (interval.low, interval.high):
        z = (0.3 - end) / math.sqrt(end * (1 - end) / 50)
        assert abs(z) == pytest.approx(1.959964, abs=1e-6)


def test_nothing_can_be_said_without_trials() -> None:
    assert math.isnan(wilson(0.0, 0).low)
    assert math.isnan(clustered(np.zeros(3), np.zeros(3)).high)


def test_sites_without_trials_change_nothing() -> None:
    hits, of = np.array([3.0, 5.0, 6.0]), np.array([7.0, 7.0, 7.0])
    assert clustered(np.append(hits, 0.0), np.append(of, 0.0)) == clustered(hits, of)


def test_with_one_trial_a_site_it_is_wilson_s() -> None:
    hits = np.array([1.0, 0.0, 1.0, 1.0, 1.0])
    assert clustered(hits, np.ones(5)) == wilson(0.8, 5)


def test_sites_that_win_or_lose_as_a_whole_count_about_once_each() -> None:
    hits = np.repeat([7.0, 0.0], [30, 10])
    assert 33 < effective_trials(hits, np.full(40, 7.0)) < 42


def test_sites_that_are_all_alike_count_almost_as_independent_trials() -> None:
    of = np.full(40, 8.0)
    assert effective_trials(np.full(40, 4.0), of) > 0.9 * of.sum()


def test_one_site_tells_no_more_than_one_trial() -> None:
    assert effective_trials(np.array([6.0]), np.array([7.0])) == 1.0


@given(SITES)
def test_a_clustered_interval_holds_the_share_and_is_never_narrower_than_wilson_s(
    sites: list[tuple[int, int]],
) -> None:
    hits, of = np.array(sites, dtype=float).T
    share, trials = hits.sum() / of.sum(), of.sum()
    found, plain = clustered(hits, of), wilson(share, trials)
    assert 0.0 <= found.low <= share <= found.high <= 1.0
    assert found.low <= plain.low + 1e-12
    assert found.high >= plain.high - 1e-12


@given(SITES)
def test_hits_and_misses_are_told_alike(sites: list[tuple[int, int]]) -> None:
    hits, of = np.array(sites, dtype=float).T
    found, mirrored = clustered(hits, of), clustered(of - hits, of)
    assert found.low == pytest.approx(1 - mirrored.high, abs=1e-9)
    assert found.high == pytest.approx(1 - mirrored.low, abs=1e-9)


@given(SITES, st.randoms(use_true_random=False))
def test_the_order_of_sites_does_not_matter(sites: list[tuple[int, int]], random) -> None:
    hits, of = np.array(sites, dtype=float).T
    order = random.sample(range(len(sites)), len(sites))
    found, again = clustered(hits, of), clustered(hits[order], of[order])
    assert (found.low, found.high) == pytest.approx((again.low, again.high), abs=1e-12)
