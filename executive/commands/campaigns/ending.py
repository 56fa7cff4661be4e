"""What is told at the end of a campaign: figures, missed bounds, and how to go on."""

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from executive.campaign.execution.progress import Progress
from executive.campaign.figures.figures import Difference, Estimate, Judgement
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.repetition import repetition
from executive.campaign.reporting.report import CampaignReport
from executive.campaign.reporting.summary import MetricWords, Runs, Summary
from executive.campaign.reporting.wording import NOTHING, figure, interval
from executive.commands.campaigns.progress import run_words

_FIGURES = 40  # lines; the report holds the rest
_STATISTICS = ("share", "median", "p95")


def ending(folder: Path, report: CampaignReport, progress: Progress) -> Iterator[str]:
    """Yield the lines that tell how a campaign ended."""
    summary = report.summary
    yield f"{summary.campaign.name}: {_runs(summary.campaign.runs)}"
    yield from _shortened(list(_figures(summary)))
    for difference in summary.figures.differences:
        yield f"  {_difference(difference, summary)}"
    missed = [one for one in summary.figures.judgements if not one.is_met]
    for one in missed:
        yield f"MISSED {_judgement(one, summary)}"
    if summary.figures.judgements and not missed:
        yield f"all {len(summary.figures.judgements)} bounds are met"
    failed = next((one for one in report.results if one.has_failed), None)
    if failed is not None:
        yield f"first failure: {run_words(failed)}"
        command = repetition(folder, failed)
        if command:
            yield f"  repeat it  {command}"
    yield f"  folder     {folder}"
    if not progress.is_complete:
        why = f", stopped by {progress.stopped_by}" if progress.stopped_by else ""
        yield f"{summary.campaign.runs.missing} runs have not ended{why}; what has ended is kept"
        yield f"  go on      executive campaign {shlex.quote(str(folder))} --resume"


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
    for one in summary.figures.estimates:
        metric = summary.campaign.metrics[one.metric]
        yield f"  {one.metric:20} {cells.name(one.levels):24} {_estimate(one, metric)}"


def _estimate(one: Estimate, metric: MetricWords) -> str:
    if not one.statistics:
        return f"nothing measured in {one.runs} runs"
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
    return f"{', '.join(parts)}; {counted} in {one.runs} runs"


def _difference(one: Difference, summary: Summary) -> str:
    others = Cells(summary.campaign.factors).name(one.others) if one.others else ""
    where = f" at {others}" if others else ""
    return f"{one.metric}: {one.level} against {one.baseline}{where}: {one.words}"


def _judgement(one: Judgement, summary: Summary) -> str:
    bound = one.bound
    metric = summary.campaign.metrics[bound.metric]
    value = figure(one.value, metric.unit, metric.is_share)
    limit = figure(bound.limit, metric.unit, metric.is_share)
    named = "" if bound.statistic == "share" else f"{bound.statistic} of "
    side = "at least" if bound.is_least else "at most"
    cell = Cells(summary.campaign.factors).name(one.levels) if one.levels else ""
    where = f" ({cell})" if cell else ""
    sure = "" if one.is_sure else "; too few runs to be sure"
    got = "nothing was measured" if value == NOTHING else f"it is {value}"
    return f"{named}{bound.metric}{where}: {got}, and was to be {side} {limit}{sure}"


def _shortened(lines: Sequence[str]) -> Sequence[str]:
    if len(lines) <= _FIGURES:
        return lines
    return [*lines[:_FIGURES], f"  … and {len(lines) - _FIGURES} more, in the report"]
