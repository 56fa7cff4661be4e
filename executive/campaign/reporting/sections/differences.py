"""Paired differences between variants on the same seeds."""

from collections.abc import Sequence

from executive.campaign.figures.figures import Difference
from executive.campaign.reporting.cells import ALL_RUNS, Cells
from executive.campaign.reporting.charts.dots import Dot, dots_chart
from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.charts.spec import ACCENT, BAD, GOOD, SOFT
from executive.campaign.reporting.page.markup import Markup, paragraph, table, tag
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.sections.chart_notes import left_out
from executive.campaign.reporting.summary import MetricWords, Summary
from executive.campaign.reporting.wording import amount, interval, points

_COLOURS = {"better": GOOD, "worse": BAD, "alike": ACCENT, "too few runs to tell": SOFT}


def differences(page: Page, summary: Summary, cells: Cells) -> list[Markup]:
    """Return a chart a metric and factor, and the table with the sentences of the verdicts."""
    found = summary.figures.differences
    if not found:
        return [paragraph("This campaign compares nothing with another.", class_="note")]
    parts: list[Markup] = []
    for metric, factor in dict.fromkeys((one.metric, one.factor) for one in found):
        of = [one for one in found if (one.metric, one.factor) == (metric, factor)]
        words = summary.campaign.metrics[metric]
        title = f"{words.title}: {factor} against {of[0].baseline}"
        parts.append(tag("h3", title))
        measured = [one for one in of if one.pairs]
        if measured:
            chart = _chart(measured, words, cells)
            parts.append(page.chart(Picture(f"difference-{metric}-{factor}", title, chart)))
        parts += [*left_out(len(measured)), _table(of, words, cells)]
    return parts


def _chart(of: Sequence[Difference], words: MetricWords, cells: Cells) -> dict[str, object]:
    dots = [
        Dot(
            compared(one, cells),
            one.difference,
            one.interval,
            _kind(one),
            f"{difference(one, words)} ({interval_of(one, words)})",
        )
        for one in of
    ]
    kinds = {kind: colour for kind, colour in _COLOURS.items() if any(d.kind == kind for d in dots)}
    unit = "share" if words.is_share else words.unit
    better = "more" if words.is_more_better else "less"
    axis = {"title": f"difference [{unit or '1'}], with its 95 % interval; {better} is better"}
    if words.is_share:
        axis["format"] = "+%"
    return dots_chart(dots, axis, kinds, is_about_zero=True)


def compared(one: Difference, cells: Cells) -> str:
    """Return what is compared: the level, and the levels of the other factors."""
    others = cells.name(one.others) if one.others else ALL_RUNS
    return one.level if others == ALL_RUNS else f"{one.level}, {others}"


def difference(one: Difference, words: MetricWords) -> str:
    """Return the difference with its sign: of shares in percentage points."""
    if words.is_share:
        return points(one.difference)
    told = amount(one.difference, words.unit)
    return f"+{told}" if one.difference > 0 else told


def interval_of(one: Difference, words: MetricWords) -> str:
    """Return the interval of a difference."""
    if words.is_share:
        return f"{points(one.interval.low).removesuffix(' points')} to {points(one.interval.high)}"
    return interval(one.interval, words.unit)


def _kind(one: Difference) -> str:
    return "too few runs to tell" if one.verdict == "too_few" else one.verdict


def _table(of: Sequence[Difference], words: MetricWords, cells: Cells) -> Markup:
    heads = ("compared", "difference", "95 % interval", "pairs", "better", "worse", "verdict")
    rows = [
        (
            compared(one, cells),
            difference(one, words),
            interval_of(one, words),
            f"{one.pairs:,}",
            f"{one.better:,}",
            f"{one.worse:,}",
            tag("span", one.words, class_={"better": "good", "worse": "bad"}.get(one.verdict, "")),
        )
        for one in of
    ]
    return table(heads, rows, numbers=(1, 2, 3, 4, 5))
