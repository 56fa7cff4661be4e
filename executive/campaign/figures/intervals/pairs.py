"""Intervals of differences between two levels on the same seeds."""

import math

import numpy as np
from scipy import special

from executive.arrays import Float
from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.share import clustered

_CONTINUITY = 0.5  # of the sum of products of residuals: n/2 of Newcombe's `ad − bc`


def difference_of_shares(
    hits: Float, of: Float, base_hits: Float, base_of: Float
) -> tuple[float, Interval]:
    """Return the difference of two shares, level minus baseline, with its interval.

    The interval joins the two intervals of the shares and the correlation of the pairs. With one
    trial a pair it is Newcombe's for paired proportions, whose correlation is corrected for
    continuity.

    Args:
        hits: Hits of the level by pair, shape (K,).
        of: Trials of the level by pair, more than 0, shape (K,).
        base_hits: Hits of the baseline by pair, shape (K,).
        base_of: Trials of the baseline by pair, more than 0, shape (K,).

    Source: Newcombe 1998, Stat. Med. 17, 2635–2650, method 10; for shares within sites its general
    form: Zou & Donner 2008, Stat. Med. 27, 1693–1702 (MOVER), over the intervals of clustered
    shares.
    """
    share, base = float(hits.sum() / of.sum()), float(base_hits.sum() / base_of.sum())
    own, other = clustered(hits, of), clustered(base_hits, base_of)
    is_single = bool((of == 1).all() and (base_of == 1).all())
    correction = _CONTINUITY if is_single else 0.0
    correlation = _correlation(hits - share * of, base_hits - base * base_of, correction)
    difference = share - base
    low = _joined(share - own.low, other.high - base, correlation)
    high = _joined(own.high - share, base - other.low, correlation)
    return difference, Interval(difference - low, difference + high)


def _joined(one: float, other: float, correlation: float) -> float:
    return math.sqrt(max(0.0, one**2 - 2 * correlation * one * other + other**2))


def _correlation(one: Float, other: Float, correction: float) -> float:
    """Return the correlation of residuals; 0 where one of them does not vary.

    For one trial a pair it is the coefficient phi of the table of pairs. A positive one is made
    smaller by the correction.
    """
    scale = math.sqrt(float(one @ one) * float(other @ other))
    product = float(one @ other)
    if product > 0:
        product = max(0.0, product - correction)
    return product / scale if scale > 0 else 0.0


def sign_test(better: int, worse: int) -> float:
    """Return the two-sided p-value of the exact sign test on pairs that differ.

    For one trial a pair it is McNemar's exact test.

    Source: McNemar 1947, Psychometrika 12, 153–157, with the exact binomial distribution.
    """
    differing = better + worse
    if not differing:
        return 1.0
    return min(1.0, 2.0 * float(special.bdtr(min(better, worse), differing, 0.5)))


def medians_by_seed(seeds: Float, values: Float) -> tuple[Float, Float]:
    """Return the seeds that have values, ascending, and the median of the values of each."""
    order = np.lexsort((values, seeds))
    seeds, values = seeds[order], values[order]
    unique, first, count = np.unique(seeds, return_index=True, return_counts=True)
    middle = values[first + (count - 1) // 2] + values[first + count // 2]
    return unique, middle / 2
