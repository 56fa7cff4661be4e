"""Intervals of shares: Wilson's, for independent and for clustered trials."""

import math

import numpy as np

from executive.arrays import Float
from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.level import Z, student


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
    estimator over sites divided by that of independent trials; it is never taken below 1, so that
    the interval is never narrower than that of independent trials. Few sites tell their variance
    badly, which the ratio of Student's quantiles accounts for. If all trials ended alike, nothing
    shows how alike those of one site are, and each site counts as one trial.

    Args:
        hits: Hits of each site, shape (K,).
        of: Trials of each site, more than 0, shape (K,).

    Source: Korn & Graubard 1998, Survey Methodology 24(2), 193–201; Dean & Pagano 2015, J. Survey
    Stat. Methodol. 3(4), 484–503, who find Wilson's interval with it to hold its level.
    """
    sites, trials = len(of), float(of.sum())
    if sites == trials:
        return trials
    share = float(hits.sum()) / trials
    if sites < 2 or share in (0.0, 1.0):
        return float(sites)
    variance = sites / (sites - 1) * float(np.sum((hits - share * of) ** 2)) / trials**2
    design_effect = max(1.0, variance * trials / (share * (1 - share)))
    return trials / design_effect * (student(trials - 1) / student(sites - 1)) ** 2


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
