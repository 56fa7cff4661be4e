"""Runs without an answer and missions without success, each with the command that repeats it."""

import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.last_lines import last_lines
from executive.campaign.reporting.page.markup import Markup, joined, paragraph, table, tag
from executive.campaign.reporting.repetition import repetition
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.wording import number_ranges, plural, shortened

MOST_SHOWN = 20  # with their journals
MOST_LISTED = 200  # in a table
_MOST_REASONS = 20


def failures(folder: Path, results: Sequence[Result], cells: Cells) -> list[Markup]:
    """Return what failed: reasons with their counts, then runs one by one.

    Args:
        folder: The campaign's folder.
        results: All results.
        cells: Names of cells.
    """
    failed = [result for result in results if result.has_failed]
    if not failed:
        return [paragraph("None: every run has an answer, and every mission succeeded.")]
    without = [result for result in failed if not result.has_answer]
    unsuccessful = [result for result in failed if result.has_answer]
    shown = [*without, *unsuccessful][:MOST_SHOWN]
    listed = [*without, *unsuccessful][MOST_SHOWN:MOST_LISTED]
    counted = (
        f"{plural(len(without), 'run')} without an answer and "
        f"{plural(len(unsuccessful), 'mission')} without success, of {plural(len(results), 'run')}."
    )
    parts = [paragraph(counted), _reasons(failed)]
    parts += [_run(folder, result, cells) for result in shown]
    if listed:
        parts.append(_table(listed, cells))
    left_out = len(failed) - len(shown) - len(listed)
    if left_out:
        told = f"{plural(left_out, 'further run')} that failed: see results.csv."
        parts.append(paragraph(told, class_="note"))
    return parts


def status_words(result: Result) -> str:
    """Return how a run ended: without an answer, or the mission's outcome."""
    return result.outcome if result.has_answer else result.status.value.replace("_", " ")


def _reasons(failed: Sequence[Result]) -> Markup:
    """Return reasons with their counts; reasons that differ in numbers alone are one."""
    alike: dict[tuple[str, str], list[Result]] = defaultdict(list)
    for result in failed:
        pattern = re.sub(r"\d+(\.\d+)?", "#", result.reason)
        alike[status_words(result), pattern].append(result)
    ordered = sorted(alike.items(), key=lambda one: -len(one[1]))
    rows = [
        (
            status,
            shortened(of[0].reason if len(of) == 1 else pattern, 200),
            f"{len(of):,}",
            shortened(number_ranges(one.trial.seed for one in of), 60),
        )
        for (status, pattern), of in ordered[:_MOST_REASONS]
    ]
    parts = [table(("status", "reason", "runs", "seeds"), rows, numbers=(2,))]
    if len(ordered) > _MOST_REASONS:
        told = f"{plural(len(ordered) - _MOST_REASONS, 'further reason')} are not listed."
        parts.append(paragraph(told, class_="note"))
    return joined(parts)


def _run(folder: Path, result: Result, cells: Cells) -> Markup:
    trial = result.trial
    name = f"Run {trial.number}: {status_words(result)}"
    where = f"{cells.words(trial.levels)}, seed {trial.seed}, after {result.wall_s:.1f} s"
    if result.tries > 1:
        where += f", try {result.tries}"
    command = repetition(folder, result)
    lines = last_lines(CampaignFolder(folder).run(trial.number, result.tries))
    return tag(
        "div",
        tag("h3", name),
        paragraph(where, class_="note"),
        paragraph(shortened(result.reason, 600)),
        tag("pre", command) if command else "",
        tag("pre", "\n".join(lines)) if lines else "",
        class_="run",
    )


def _table(listed: Sequence[Result], cells: Cells) -> Markup:
    rows = [
        (
            str(one.trial.number),
            status_words(one),
            shortened(one.reason, 160),
            cells.name(one.trial.levels),
            str(one.trial.seed),
        )
        for one in listed
    ]
    return table(("run", "status", "reason", cells.title, "seed"), rows, numbers=(0, 4))
