"""Distributions of measured values, with medians and tails."""

from collections.abc import Mapping, Sequence

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.charts.distribution import MOST_LINES, distribution_chart
from executive.campaign.reporting.charts.dots import Dot, dots_chart
from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.charts.spec import ACCENT, TAIL
from executive.campaign.reporting.page.markup import Markup, paragraph, prose, tag
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.sections.chart_notes import left_out, limit_on
from executive.campaign.reporting.sections.phases import is_phase
from executive.campaign.reporting.summary import MetricWords, Summary
from executive.campaign.reporting.wording import amount, interval, plural
from executive.interfaces.metric import Values

_SHOWN = {"median": ("median", ACCENT), "p95": ("95th percentile", TAIL)}


def distributions(
    page: Page, summary: Summary, by_cell: Mapping[str, Sequence[Result]], cells: Cells
) -> list[Markup]:
    """Return the charts of each metric of values: its distribution, and median and tail by cell."""
    parts: list[Markup] = []
    for metric, words in summary.campaign.metrics.items():
        if is_phase(words):
            continue
        measured = [
            one
            for one in summary.figures.estimates
            if one.metric == metric and "median" in one.statistics and one.of
        ]
        if not measured:
            continue
        parts += [tag("h3", words.title), paragraph(prose(words.description), class_="note")]
        values = {name: _values(metric, of) for name, of in by_cell.items()}
        everywhere = {value for found in values.values() for value in found}
        if len(everywhere) == 1:
            count = sum(map(len, values.values()))
            told = f"{plural(count, 'value')}, all {amount(everywhere.pop(), words.unit)}."
            parts.append(paragraph(told))
            continue
        if len(measured) <= MOST_LINES:
            chart = distribution_chart(values, axis_of(words))
            parts.append(page.chart(Picture(f"distribution-{metric}", words.title, chart)))
        if len(measured) > 1:
            parts.append(page.chart(_tails(metric, words, measured, summary, cells)))
            parts += left_out(len(measured))
    return parts


def _values(metric: str, results: Sequence[Result]) -> list[float]:
    """Return a metric's values in ascending order."""
    measured = (result.measurements.get(metric) for result in results)
    return sorted(value for one in measured if isinstance(one, Values) for value in one.values)


def axis_of(words: MetricWords) -> dict[str, str]:
    """Return the axis of a metric: its title with the unit, and bytes as 400M."""
    title = f"{words.title} [{words.unit}]" if words.unit else words.title
    return {"title": title, "format": "~s"} if words.unit == "byte" else {"title": title}


def _tails(
    metric: str,
    words: MetricWords,
    measured: Sequence[Estimate],
    summary: Summary,
    cells: Cells,
) -> Picture:
    dots = [
        _dot(cells.name(one.levels), one, statistic, words, summary)
        for one in measured
        for statistic in _SHOWN
        if statistic in one.statistics
    ]
    axis = axis_of(words)
    axis["title"] += ", with 95 % intervals"
    chart = dots_chart(dots, axis, dict(_SHOWN.values()), cells.title)
    return Picture(f"values-{metric}", f"{words.title}: median and tail", chart)


def _dot(
    name: str, estimate: Estimate, statistic: str, words: MetricWords, summary: Summary
) -> Dot:
    value, within = estimate.statistics[statistic]
    told = f"{amount(value, words.unit)} ({interval(within, words.unit)}), {estimate.of} values"
    limit = limit_on(summary, estimate, statistic)
    return Dot(name, value, within, _SHOWN[statistic][0], told, limit)
