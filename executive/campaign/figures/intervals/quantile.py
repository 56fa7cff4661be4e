"""Intervals of quantiles, free of assumptions on the distribution."""

import math
from functools import lru_cache

import numpy as np
from scipy import special

from executive.arrays import Float
from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.level import TAIL
from executive.campaign.figures.intervals.share import effective_trials

_WINDOW = 10.0  # standard deviations of the number of values below a quantile; beyond is certain


def quantile(values: Float, probability: float) -> float:
    """Return a quantile of values, linear between them (numpy's default); NaN without values."""
    return float(np.quantile(values, probability)) if len(values) else math.nan


def quantile_interval(values: Float, sites: Float, probability: float) -> Interval:
    """Return the interval of a quantile between two of the values.

    Of n independent values the number below the true quantile is binomial, which gives the ranks of
    the two. Values of one site resemble each other, so that n is the effective number of the share
    of values below the quantile. An end is NaN where so few values bound the quantile on one side
    only: the 95th percentile of 20 values may well lie above the largest of them.

    Args:
        values: All values, shape (N,).
        sites: Number of the site of each value, from 0, shape (N,).
        probability: Which quantile, 0.5 for the median.

    Source: Woodruff 1952, J. Am. Stat. Assoc. 47(260), 635–646, with exact ranks.
    """
    if len(values) < 2:
        return Interval(math.nan, math.nan)
    at = quantile(values, probability)
    _, inverse = np.unique(sites, return_inverse=True)
    of = np.bincount(inverse).astype(np.float64)
    below = np.bincount(inverse[values <= at], minlength=len(of)).astype(np.float64)
    independent = max(1, math.floor(effective_trials(below, of) + 1e-9))
    lower, upper = _ranks(independent, probability)
    ordered = np.sort(values)
    scale = (len(values) + 1) / (independent + 1)
    low = math.floor(lower * scale + 1e-9)
    high = math.ceil(upper * scale - 1e-9)
    return Interval(
        float(ordered[low - 1]) if lower >= 1 else math.nan,
        float(ordered[high - 1]) if upper <= independent else math.nan,
    )


@lru_cache(maxsize=4096)
def _ranks(n: int, probability: float) -> tuple[int, int]:
    """Return the ranks, from 1, between which the quantile of n values is; 0 and n + 1 for none."""
    deviation = math.sqrt(n * probability * (1 - probability))
    first = max(0, math.floor(n * probability - _WINDOW * deviation))
    last = min(n, math.ceil(n * probability + _WINDOW * deviation))
    # Probability that 0, 1 … n values are below the quantile, where it is neither 0 nor 1.
    cumulative = special.bdtr(np.arange(first, last + 1), n, probability)
    lower = first + int(np.searchsorted(cumulative, TAIL, side="right"))
    upper = first + int(np.searchsorted(cumulative, 1 - TAIL, side="left")) + 1
    return lower, upper
