"""How long each phase of a mission takes."""

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.charts.bars import MOST_KINDS, Bar, bars_chart
from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.page.markup import Markup, paragraph
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.summary import MetricWords, Summary
from executive.campaign.reporting.wording import amount

_PREFIX = "phase: "  # titles of metrics that measure a phase begin so


def is_phase(words: MetricWords) -> bool:
    """Return whether a metric is the duration of a phase."""
    return words.title.startswith(_PREFIX)


def phases(page: Page, summary: Summary, cells: Cells) -> list[Markup]:
    """Return a bar a phase and cell: its median duration, with its 95th percentile."""
    metrics = summary.campaign.metrics
    found = [
        one
        for metric, words in metrics.items()
        if is_phase(words)
        for one in summary.figures.estimates
        if one.metric == metric and "median" in one.statistics and one.of
    ]
    if not found:
        return [paragraph("This campaign reports no durations of phases.", class_="note")]
    if len({cells.name(one.levels) for one in found}) > MOST_KINDS:
        told = "More cells than colours can tell apart: see the tables below."
        return [paragraph(told, class_="note")]
    bars = [_bar(metrics[one.metric], one, cells) for one in found]
    picture = Picture("phases", "Median duration of each phase", bars_chart(bars, "duration [s]"))
    note = "Bars are medians, and ticks are 95th percentiles."
    return [page.chart(picture), paragraph(note, class_="note")]


def _bar(words: MetricWords, one: Estimate, cells: Cells) -> Bar:
    median, p95 = (one.statistics[name][0] for name in ("median", "p95"))
    told = f"median {amount(median, words.unit)}, 95th percentile {amount(p95, words.unit)}"
    return Bar(words.title.removeprefix(_PREFIX), cells.name(one.levels), median, p95, told)
