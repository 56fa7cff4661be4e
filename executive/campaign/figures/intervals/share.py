"""Intervals of shares: Wilson's, for independent and for clustered trials."""

import math

import numpy as np

from executive.arrays import Float
from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.level import Z, student

_HALF_A_SITE = 0.5


def wilson(share: float, trials: float) -> Interval:
    """Return Wilson's score interval of a share; NaN without trials.

    Args:
        share: Observed share, 0 to 1.
        trials: Number of independent trials, or the effective number; it need not be whole.

    Source: Wilson 1927, J. Am. Stat. Assoc. 22(158), Eq. (15).
    """
    if trials <= 0:
        return Interval(math.nan, math.nan)
    centre = (share + Z**2 / (2 * trials)) / (1 + Z**2 / trials)
    root = math.sqrt(share * (1 - share) / trials + Z**2 / (4 * trials**2))
    half = Z / (1 + Z**2 / trials) * root
    low = 0.0 if share <= 0 else centre - half  # exactly, without the error of rounding
    high = 1.0 if share >= 1 else centre + half
    return Interval(low, high)


def effective_trials(hits: Float, of: Float) -> float:
    """Return the number of independent trials that tell as much as these clustered ones.

    Trials within one site resemble each other. The design effect is the variance of the ratio
    estimator over sites divided by that of independent trials. It is never taken below 1, so that
    the interval is never narrower than that of independent trials, and never below what it would be
    with half a site more of which half the trials are hits: where nearly all trials end alike, the
    sites show too little of how alike their trials are. Few sites tell their variance badly, which
    the ratio of Student's quantiles accounts for.

    Args:
        hits: Hits of each site, shape (K,).
        of: Trials of each site, more than 0, shape (K,).

    Source: Korn & Graubard 1998, Survey Methodology 24(2), 193–201; Dean & Pagano 2015, J. Survey
    Stat. Methodol. 3(4), 484–503, who find Wilson's interval with it to hold its level. The half
    site is our own: without it 95 % are 78 % where stones of 20 sites resemble each other by 0.6
    and 95 % are placed (tests/campaign/figures/test_coverage.py).
    """
    sites, trials = len(of), float(of.sum())
    if sites == trials:
        return trials
    if sites < 2:
        return 1.0
    usual = trials / sites  # trials of a site
    more_hits = np.append(hits, usual / 2)
    more_of = np.append(of, usual)
    weights = np.append(np.ones(sites), _HALF_A_SITE)
    effect = max(
        1.0,
        _design_effect(hits, of, np.ones(sites)),
        _design_effect(more_hits, more_of, weights),
    )
    return trials / effect * (student(trials - 1) / student(sites - 1)) ** 2


def _design_effect(hits: Float, of: Float, weights: Float) -> float:
    """Return the design effect of sites that count with weights; 0 where all trials end alike."""
    sites, trials = float(weights.sum()), float(weights @ of)
    share = float(weights @ hits) / trials
    if share in (0.0, 1.0):
        return 0.0
    spread = float(weights @ (hits - share * of) ** 2)
    return sites / (sites - 1) * spread / (trials * share * (1 - share))


def clustered(hits: Float, of: Float) -> Interval:
    """Return the interval of a share whose trials belong to sites; NaN without trials.

    Args:
        hits: Hits of each site, shape (K,).
        of: Trials of each site, shape (K,); sites without trials tell nothing.
    """
    hits, of = hits[of > 0], of[of > 0]
    if not len(of):
        return Interval(math.nan, math.nan)
    return wilson(float(hits.sum() / of.sum()), effective_trials(hits, of))
