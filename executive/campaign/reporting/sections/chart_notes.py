"""What the charts of several sections share: bounds on figures, and what a chart leaves out."""

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.charts.spec import MOST_ROWS
from executive.campaign.reporting.page.markup import Markup, paragraph
from executive.campaign.reporting.summary import Summary
from executive.campaign.reporting.wording import plural


def left_out(count: int) -> list[Markup]:
    """Return how many rows a chart leaves out, of so many; nothing if it shows all."""
    if count <= MOST_ROWS:
        return []
    told = f"{plural(count - MOST_ROWS, 'further row')}: see the tables and results.csv."
    return [paragraph(told, class_="note")]


def limit_on(summary: Summary, estimate: Estimate, statistic: str) -> float | None:
    """Return the bound on a statistic of an estimate; None if there is none."""
    for one in summary.figures.judgements:
        is_of_this = one.bound.metric == estimate.metric and one.bound.statistic == statistic
        if is_of_this and dict(one.levels) == dict(estimate.levels):
            return one.bound.limit
    return None
