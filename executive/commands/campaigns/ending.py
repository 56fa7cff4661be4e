"""What is told at the end of a campaign: figures, missed bounds, and how to go on."""

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from executive.campaign.execution.progress import Progress
from executive.campaign.figures.figures import Difference, Estimate, Figures, Judgement
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.repetition import repetition
from executive.campaign.reporting.report import CampaignReport
from executive.campaign.reporting.summary import MetricWords, Runs, Summary
from executive.campaign.reporting.wording import NOTHING, figure, interval, plural
from executive.commands.campaigns.progress import run_words

_FIGURES = 40  # lines; the report holds the rest
_STATISTICS = ("share", "median", "p95")


def ending(folder: Path, report: CampaignReport, progress: Progress) -> Iterator[str]:
    """Yield the lines that tell how a campaign ended."""
    summary = report.summary
    figures = summary.figures
    yield f"{summary.campaign.name}: {_runs(summary.campaign.runs)}"
    yield from _shortened(list(_figures(summary)))
    yield from _shortened([_difference(one, summary) for one in figures.differences if one.pairs])
    missed = [one for one in figures.judgements if not one.is_met]
    yield from (f"missed: {_judgement(one, summary)}" for one in missed)
    if figures.judgements and not missed:
        so_far = "" if progress.is_complete else " so far"
        yield f"every bound is met{so_far} ({len(figures.judgements)})"
    failed = next((one for one in report.results if one.has_failed), None)
    if failed is not None:
        yield f"first failure: {run_words(failed)}"
        command = repetition(folder, failed)
        if command:
            yield f"  repeat it  {command}"
    if not progress.is_complete:
        yield f"{plural(summary.campaign.runs.missing, 'run')} left; what has ended is kept"
        yield f"  go on      executive campaign {shlex.quote(str(folder))} --resume"
    yield f"  folder     {folder}"


def _runs(runs: Runs) -> str:
    ended = runs.done + runs.without_answer
    words = f"{ended} of {runs.asked} runs ended"
    return (
        f"{words}; {runs.not_successful} without success, {runs.without_answer} without an answer "
        "(crashed, killed, or beyond a limit); both count as failed"
        if runs.without_answer or runs.not_successful
        else words
    )


def _figures(summary: Summary) -> Iterator[str]:
    cells = Cells(summary.campaign.factors)
    asked = _asked(summary.figures)
    told = [one for one in summary.figures.estimates if one.of and one.metric in asked]
    names = {id(one): (one.metric, cells.name(one.levels)) for one in told}
    widths = [max((len(name[i]) for name in names.values()), default=0) for i in (0, 1)]
    for one in told:
        name, cell = names[id(one)]
        words = _estimate(one, summary.campaign.metrics[one.metric])
        yield f"  {name:{widths[0]}}  {cell:{widths[1]}}  {words}"
    silent = [name for name in asked if name not in {one.metric for one in told}]
    if silent:
        yield f"  nothing to measure: {', '.join(silent)}"
    others = len({one.metric for one in summary.figures.estimates}) - len(asked)
    if others:
        yield f"  {plural(others, 'more metric')} in the report"


def _asked(figures: Figures) -> Sequence[str]:
    """Return the metrics that are bounded or compared; all if none is."""
    bounded = (one.bound.metric for one in figures.judgements)
    compared = (one.metric for one in figures.differences)
    estimated = (one.metric for one in figures.estimates)
    asked = {*bounded, *compared}
    return tuple(dict.fromkeys(name for name in estimated if not asked or name in asked))


def _estimate(one: Estimate, metric: MetricWords) -> str:
    parts = []
    for name in _STATISTICS:
        if name not in one.statistics:
            continue
        value, between = one.statistics[name]
        words = figure(value, metric.unit, metric.is_share)
        range_ = interval(between, metric.unit, metric.is_share)
        named = "" if name == "share" else f"{name} "
        parts.append(f"{named}{words}" + ("" if range_ == NOTHING else f" ({range_})"))
    counted = f"{one.hits} of {one.of}" if metric.is_share else f"{one.of} values"
    return f"{', '.join(parts)}; {counted} in {plural(one.runs, 'run')}"


def _difference(one: Difference, summary: Summary) -> str:
    others = Cells(summary.campaign.factors).name(one.others) if one.others else ""
    where = f" at {others}" if others else ""
    return f"  {one.metric}: {one.level} against {one.baseline}{where}: {one.words}"


def _judgement(one: Judgement, summary: Summary) -> str:
    bound = one.bound
    metric = summary.campaign.metrics[bound.metric]
    value = figure(one.value, metric.unit, metric.is_share)
    limit = figure(bound.limit, metric.unit, metric.is_share)
    named = "" if bound.statistic == "share" else f"{bound.statistic} of "
    side = "at least" if bound.is_least else "at most"
    cell = Cells(summary.campaign.factors).name(one.levels) if one.levels else ""
    where = f" ({cell})" if cell else ""
    sure = "" if one.is_sure else "; more runs may show otherwise"
    got = "has nothing to measure" if value == NOTHING else f"is {value}"
    return f"{named}{bound.metric}{where} {got}, {side} {limit} was asked for{sure}"


def _shortened(lines: Sequence[str]) -> Sequence[str]:
    if len(lines) <= _FIGURES:
        return lines
    return [*lines[:_FIGURES], f"  … and {len(lines) - _FIGURES} more, in the report"]
