"""The report of a single run: a page, and an answer for programs."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.last_lines import last_lines
from executive.campaign.reporting.page.markup import Markup, listing, pairs, paragraph, table, tag
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.quantile import quantile
from executive.campaign.reporting.runs.read_run import ReadRun, words_of
from executive.campaign.reporting.runs.timeline import attempt_bars, leaf_bars, timeline
from executive.campaign.reporting.wording import NOTHING, amount, percent
from executive.events.event import plain
from executive.extras import require_extra
from executive.interfaces.report import MissionReport, PickReport, Timing
from executive.interfaces.truth import TrueStone, Truth

PAGE = "report.html"
_NO_METRICS = "None: the run has not reported by itself."


def report_run(run: ReadRun) -> Path:
    """Write the page of a run into its folder, and return the page.

    Raises:
        MissingExtraError: If the packages of the extra `reports` are not installed.
    """
    require_extra("the report of a run", "reports")
    page = _page(run)
    page.write(run.folder / PAGE)
    return run.folder / PAGE


def run_answer(run: ReadRun) -> dict[str, Any]:
    """Return the report of a run for programs: its `report.json`, and what was made of it."""
    return {
        "folder": str(run.folder),
        "damages": list(run.damages),
        "command": run.command,
        "report": {} if run.report is None else run.report.payload(),
        "measurements": {name: dict(found) for name, found in run.measurements.items()},
        "journal": {"entries": len(run.entries), "last": last_lines(run.folder)},
    }


def measured_words(name: str, measured: Mapping[str, Any]) -> str:
    """Return what a metric measured on a run, for a person."""
    unit = words_of(name).unit
    if "problem" in measured:
        return f"not measured: {measured['problem']}"
    if "hits" in measured:
        share = f" ({percent(measured['hits'] / measured['of'])})" if measured["of"] else ""
        return f"{measured['hits']} of {measured['of']}{share}"
    values = sorted(measured["values"])
    if len(values) < 2:
        return amount(values[0], unit) if values else NOTHING
    median, largest = amount(quantile(values, 0.5), unit), amount(values[-1], unit)
    return f"median {median}, largest {largest}, of {len(values)}"


def _page(run: ReadRun) -> Page:
    report, whole = run.report, run.whole
    name = run.folder.name if report is None else report.mission
    page = Page(f"{name}, seed {NOTHING if whole is None else whole.seed}")
    page.add(_head(run))
    if run.damages:
        page.section("What could not be read", listing(run.damages))
    if report is not None and report.fault is not None:
        told = asdict(report.fault).items()
        page.section("Fault", tag("pre", "\n".join(f"{k}: {v}" for k, v in told if v)))
    attempts = [] if whole is None else list(attempt_bars(whole.picks))
    if whole is not None and attempts:
        picture = Picture("attempts", "Attempts at each stone", timeline(attempts))
        page.section("Stones", page.chart(picture), _picks(whole.picks))
    bars = leaf_bars(run.entries)
    if bars:
        page.section(
            "Course", page.chart(Picture("course", "When each leaf was active", timeline(bars)))
        )
    page.section("Metrics", _metrics(run))
    if whole is not None:
        _add_figures(page, whole)
    page.section("Last lines of the journal", tag("pre", "\n".join(last_lines(run.folder, 20))))
    return page


def _add_figures(page: Page, report: MissionReport) -> None:
    """Add the truth, what the run took from the computer, and its counts."""
    if report.truth is not None:
        page.section("Truth", *_truth(report.truth))
    used = asdict(report.resources).items()
    page.section("Resources", pairs((name, _plain(value, name)) for name, value in used))
    if report.timings_ms:
        page.section("Wall time of each stage", _timings(report.timings_ms))
    page.section("Counts", pairs((k, str(v)) for k, v in asdict(report.counts).items()))


def _head(run: ReadRun) -> Markup:
    report, whole = run.report, run.whole
    outcome = "unknown: there is no report" if report is None else report.outcome
    kind = "good" if outcome == "success" else "bad"
    rows: list[tuple[str, str]] = [("Outcome", tag("span", outcome, class_=kind))]
    if report is not None and report.reason:
        rows.append(("Reason", report.reason))
    if whole is not None:
        factor = amount(whole.real_time_factor)
        rows.append(("Mission time", amount(whole.ended_s, "s")))
        rows.append(("Wall time", f"{amount(whole.wall_s, 's')} ({factor} times real time)"))
    rows.append(("Journal", f"{len(run.entries):,} entries"))
    if run.command:
        rows.append(("Repeat it", tag("code", run.command)))
    return pairs(rows)


def _picks(picks: Sequence[PickReport]) -> Markup:
    rows = [
        (
            f"stone {pick.object}" if not number else "",
            str(number + 1),
            "" if attempt.success is None else f"{attempt.success:.0%}",
            attempt.outcome,
            attempt.reason,
            amount(attempt.started_s, "s"),
            amount(attempt.ended_s - attempt.started_s, "s"),
            str(pick.slot) if attempt.outcome == "placed" else "",
        )
        for pick in picks
        for number, attempt in enumerate(pick.attempts)
    ]
    heads = ("stone", "attempt", "expected", "outcome", "reason", "begun at", "took", "slot")
    aside = [
        f"Stone {pick.object} was set aside: {pick.set_aside}" for pick in picks if pick.set_aside
    ]
    parts = table(heads, rows, numbers=(1, 2, 5, 6, 7))
    return Markup(parts + listing(aside)) if aside else parts


def _metrics(run: ReadRun) -> Markup:
    rows = [
        (words_of(name).title, measured_words(name, measured))
        for name, measured in run.measurements.items()
    ]
    return table(("metric", "measured"), rows) if rows else paragraph(_NO_METRICS)


def _timings(timings: Mapping[str, Timing]) -> Markup:
    ordered = sorted(timings.items(), key=lambda one: -one[1].median * one[1].n)
    rows = [
        (stage, amount(of.median, "ms"), amount(of.p95, "ms"), f"{of.n:,}") for stage, of in ordered
    ]
    return table(("stage", "median", "95th percentile", "calls"), rows, numbers=(1, 2, 3))


def _truth(truth: Truth) -> list[Markup]:
    parts: list[Markup] = []
    if truth.collisions is not None:
        parts.append(paragraph(f"{len(truth.collisions)} collisions."))
    if truth.stones:
        columns = [one.name for one in fields(TrueStone)]
        rows = [
            [_plain(plain(getattr(stone, column)), column) for column in columns]
            for stone in truth.stones
        ]
        parts.append(table([c.replace("_", " ") for c in columns], rows, range(len(columns))))
    if truth.estimate:
        errors = [
            (f"{name.rpartition('_')[0]}, {statistic}", _plain(value, name))
            for name, of in asdict(truth.estimate).items()
            for statistic, value in of.items()
        ]
        parts.append(table(("estimated cabin", "value"), errors, numbers=(1,)))
    return parts


def _plain(value: Any, name: str) -> str:
    unit = name.rpartition("_")[2]
    if value is None:
        return NOTHING
    if unit == "bytes":
        return amount(value, "byte")
    return amount(value, unit) if isinstance(value, float) else str(value)
