"""The report of a single run: a page, and an answer for programs."""

from collections.abc import Mapping, Sequence
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
from executive.extras import require_extra

PAGE = "report.html"


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
        "report": dict(run.report),
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
    report = run.report
    page = Page(f"{report.get('mission') or run.folder.name}, seed {report.get('seed', NOTHING)}")
    page.add(_head(run))
    if run.damages:
        page.section("What could not be read", listing(run.damages))
    fault = report.get("fault")
    if fault:
        page.section("Fault", tag("pre", "\n".join(f"{k}: {v}" for k, v in fault.items() if v)))
    attempts = list(attempt_bars(report))
    if attempts:
        picture = Picture("attempts", "Attempts at each stone", timeline(attempts))
        page.section("Stones", page.chart(picture), _picks(report["picks"]))
    bars = leaf_bars(run.entries)
    if bars:
        page.section(
            "Course", page.chart(Picture("course", "When each leaf was active", timeline(bars)))
        )
    page.section("Metrics", _metrics(run))
    if report.get("truth"):
        page.section("Truth", *_truth(report["truth"]))
    if report.get("resources"):
        used = pairs((name, _plain(value, name)) for name, value in report["resources"].items())
        page.section("Resources", used)
    if report.get("timings_ms"):
        page.section("Wall time of each stage", _timings(report["timings_ms"]))
    if report.get("counts"):
        page.section("Counts", pairs((k, str(v)) for k, v in report["counts"].items()))
    page.section("Last lines of the journal", tag("pre", "\n".join(last_lines(run.folder, 20))))
    return page


def _head(run: ReadRun) -> Markup:
    report = run.report
    outcome = report.get("outcome", "unknown: there is no report")
    kind = "good" if outcome == "success" else "bad"
    rows: list[tuple[str, str]] = [("Outcome", tag("span", str(outcome), class_=kind))]
    if report.get("reason"):
        rows.append(("Reason", str(report["reason"])))
    if "ended_s" in report:
        rows.append(("Mission time", amount(report["ended_s"], "s")))
    if "wall_s" in report:
        factor = amount(report.get("real_time_factor", float("nan")))
        rows.append(("Wall time", f"{amount(report['wall_s'], 's')} ({factor} times real time)"))
    rows.append(("Journal", f"{len(run.entries):,} entries"))
    if run.command:
        rows.append(("Repeat it", tag("code", run.command)))
    return pairs(rows)


def _picks(picks: Sequence[Mapping[str, Any]]) -> Markup:
    rows = [
        (
            f"stone {pick['object']}" if not number else "",
            str(number + 1),
            attempt["outcome"],
            attempt["reason"],
            amount(attempt["started_s"], "s"),
            amount(attempt["ended_s"] - attempt["started_s"], "s"),
            str(pick["slot"]) if attempt["outcome"] == "placed" else "",
        )
        for pick in picks
        for number, attempt in enumerate(pick["attempts"])
    ]
    heads = ("stone", "attempt", "outcome", "reason", "begun at", "took", "slot")
    aside = [
        f"Stone {pick['object']} was set aside: {pick['set_aside']}"
        for pick in picks
        if pick.get("set_aside")
    ]
    parts = table(heads, rows, numbers=(1, 4, 5, 6))
    return Markup(parts + listing(aside)) if aside else parts


def _metrics(run: ReadRun) -> Markup:
    rows = [
        (words_of(name).title, measured_words(name, measured))
        for name, measured in run.measurements.items()
    ]
    return table(("metric", "measured"), rows) if rows else paragraph("None: there is no report.")


def _timings(timings: Mapping[str, Mapping[str, float]]) -> Markup:
    ordered = sorted(timings.items(), key=lambda one: -one[1]["median"] * one[1]["n"])
    rows = [
        (stage, amount(of["median"], "ms"), amount(of["p95"], "ms"), f"{of['n']:,}")
        for stage, of in ordered
    ]
    return table(("stage", "median", "95th percentile", "calls"), rows, numbers=(1, 2, 3))


def _truth(truth: Mapping[str, Any]) -> list[Markup]:
    parts: list[Markup] = [
        paragraph(f"{len(truth.get('collisions', ()))} collisions."),
    ]
    stones = truth.get("stones")
    if stones:
        columns = list(stones[0])
        rows = [[_plain(stone.get(column), column) for column in columns] for stone in stones]
        parts.append(table([c.replace("_", " ") for c in columns], rows, range(len(columns))))
    estimate = truth.get("estimate") or {}
    errors = [
        (f"{name.rpartition('_')[0]}, {statistic}", _plain(value, name))
        for name, of in estimate.items()
        for statistic, value in of.items()
    ]
    if errors:
        parts.append(table(("estimated cabin", "value"), errors, numbers=(1,)))
    return parts


def _plain(value: Any, name: str) -> str:
    unit = name.rpartition("_")[2]
    if value is None:
        return NOTHING
    if unit == "bytes":
        return amount(value, "byte")
    return amount(value, unit) if isinstance(value, float) else str(value)
