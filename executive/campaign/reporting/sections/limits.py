"""The bounds on a figure."""

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.summary import Summary


def limit_on(summary: Summary, estimate: Estimate, statistic: str) -> float | None:
    """Return the bound on a statistic of an estimate; None if there is none."""
    for one in summary.figures.judgements:
        is_of_this = one.bound.metric == estimate.metric and one.bound.statistic == statistic
        if is_of_this and dict(one.levels) == dict(estimate.levels):
            return one.bound.limit
    return None
