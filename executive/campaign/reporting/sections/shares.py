"""Shares with their intervals."""

from collections.abc import Sequence

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.charts.dots import Dot, dots_chart
from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.charts.spec import ACCENT
from executive.campaign.reporting.page.markup import Markup, paragraph, prose, tag
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.sections.chart_notes import left_out, limit_on
from executive.campaign.reporting.summary import Summary
from executive.campaign.reporting.wording import interval, percent

_SHARE = "share"
_AXIS = {"title": "share, with its 95 % interval", "format": "%"}
_SCALE = {"domain": [0, 1]}


def shares(page: Page, summary: Summary, cells: Cells) -> list[Markup]:
    """Return a chart a metric, or one of all metrics if there is one cell."""
    measured = [one for one in summary.figures.estimates if _SHARE in one.statistics and one.of]
    if len({cells.name(one.levels) for one in measured}) == 1:
        metrics = summary.campaign.metrics
        named = [(metrics[one.metric].title, one) for one in measured]
        return [page.chart(_picture("shares", "Shares", named, summary, "metric"))]
    parts: list[Markup] = []
    for metric, words in summary.campaign.metrics.items():
        named = [(cells.name(one.levels), one) for one in measured if one.metric == metric]
        if named:
            picture = _picture(f"share-{metric}", words.title, named, summary, cells.title)
            parts += [
                tag("h3", words.title),
                paragraph(prose(words.description), class_="note"),
                page.chart(picture),
                *left_out(len(named)),
            ]
    return parts


def _picture(
    name: str,
    title: str,
    named: Sequence[tuple[str, Estimate]],
    summary: Summary,
    rows_title: str,
) -> Picture:
    dots = [_dot(row, one, summary) for row, one in named]
    return Picture(name, title, dots_chart(dots, _AXIS, {_SHARE: ACCENT}, rows_title, _SCALE))


def _dot(name: str, estimate: Estimate, summary: Summary) -> Dot:
    share, within = estimate.statistics[_SHARE]
    words = (
        f"{percent(share)} ({interval(within, is_share=True)}), {estimate.hits} of {estimate.of}"
    )
    return Dot(name, share, within, _SHARE, words, limit_on(summary, estimate, _SHARE))
