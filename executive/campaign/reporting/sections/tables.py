"""All figures as tables, and what was not measured."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.page.markup import Markup, listing, paragraph, table, tag
from executive.campaign.reporting.quantile import quantile
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.summary import MetricWords, Summary
from executive.campaign.reporting.wording import amount, interval, percent, plural, shortened

_TAILS = ("median", "p90", "p95", "max")


def estimate_tables(summary: Summary, cells: Cells) -> list[Markup]:
    """Return a table a metric."""
    parts: list[Markup] = []
    for metric, words in summary.campaign.metrics.items():
        of = [one for one in summary.figures.estimates if one.metric == metric]
        if any(one.of for one in of):
            parts += [tag("h3", words.title), _table(of, words, cells)]
    return parts


def _table(of: Sequence[Estimate], words: MetricWords, cells: Cells) -> Markup:
    if words.is_share:
        heads = (cells.title, "share", "95 % interval", "hits", "of", "runs", "without answer")
        return table(heads, [_share(one, cells) for one in of], numbers=(1, 2, 3, 4, 5, 6))
    titles = (cells.title, *_TAILS, "values", "runs", "without answer")
    return table(titles, [_values(one, words, cells) for one in of], numbers=tuple(range(1, 8)))


def _share(one: Estimate, cells: Cells) -> tuple[str, ...]:
    share, within = one.statistics["share"]
    return (
        cells.name(one.levels),
        percent(share),
        interval(within, is_share=True),
        f"{one.hits:,}",
        f"{one.of:,}",
        f"{one.runs:,}",
        f"{one.without_answer:,}",
    )


def _values(one: Estimate, words: MetricWords, cells: Cells) -> tuple[str, ...]:
    figures = []
    for name in _TAILS:
        if name not in one.statistics:
            figures.append(amount(float("nan")))
            continue
        value, within = one.statistics[name]
        told = interval(within, words.unit)
        figures.append(amount(value, words.unit) + (f" ({told})" if name in _TAILS[:3] else ""))
    return (
        cells.name(one.levels),
        *figures,
        f"{one.of:,}",
        f"{one.runs:,}",
        f"{one.without_answer:,}",
    )


def resource_table(by_cell: Mapping[str, Sequence[Result]], cells: Cells) -> Markup:
    """Return what the runs took, by cell: median and largest."""
    heads = (
        cells.title,
        "runs",
        "wall, median",
        "largest",
        "processor, median",
        "largest",
        "memory, median",
        "largest",
    )
    return table(heads, [_resources(*one) for one in by_cell.items()], numbers=range(1, 8))


def _resources(name: str, of: Sequence[Result]) -> tuple[str, ...]:
    columns = (
        ([one.wall_s for one in of], "s"),
        ([one.cpu_s for one in of], "s"),
        ([float(one.peak_memory_bytes) for one in of], "byte"),
    )
    told = (
        (amount(quantile(sorted(values), 0.5), unit), amount(max(values), unit))
        for values, unit in columns
    )
    return (name, f"{len(of):,}", *(text for both in told for text in both))


def not_measured(summary: Summary, results: Sequence[Result], cells: Cells) -> list[Markup]:
    """Return which metrics hold nothing, or less than all runs, and why."""
    problems: dict[str, list[str]] = defaultdict(list)
    for result in results:
        for metric, problem in result.row.problems.items():
            problems[metric].append(problem)
    items = []
    for metric, words in summary.campaign.metrics.items():
        of = [one for one in summary.figures.estimates if one.metric == metric]
        lacking = [(one, one.runs - one.measured) for one in of if one.measured < one.runs]
        if not of:
            items.append(f"{words.title}: no figure")
        elif all(one.measured == 0 for one in of):
            items.append(f"{words.title}: no run holds anything to measure it on")
        elif lacking:
            told = "; ".join(
                f"{cells.name(one.levels)}: {count} of {plural(one.runs, 'run')}"
                for one, count in lacking[:_MOST_CELLS]
            )
            more = f"; {len(lacking) - _MOST_CELLS} more cells" * (len(lacking) > _MOST_CELLS)
            items.append(f"{words.title}: nothing to measure in {told}{more}")
        if problems[metric]:
            first = shortened(problems[metric][0], 300)
            items.append(f"{words.title}: {plural(len(problems[metric]), 'error')}, first: {first}")
    missing = summary.campaign.runs.missing
    if missing:
        items.append(f"{plural(missing, 'run')} of the campaign have not ended.")
    return [listing(items)] if items else [paragraph("Every metric was measured on every run.")]


_MOST_CELLS = 6
