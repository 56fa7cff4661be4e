"""The report of one run: request, outcome, counts, timings and, in simulation, the truth."""

import json
import resource
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from executive.events.event import plain
from executive.events.mission import Fault
from executive.mission.record.samples import Samples

NEAR_M = 0.30  # a stone within this distance of its slot, by the truth, counts as placed
_MAXRSS_BYTES = 1 if sys.platform == "darwin" else 1024  # unit of getrusage's resident memory


@dataclass(frozen=True, slots=True)
class Ending:
    """How a run ended.

    Attributes:
        outcome: success, failure, stopped or fault.
        reason: Why, for a person.
        fault: What failed, if an error of a plugin or leaf ended the run.
    """

    outcome: str
    reason: str
    fault: Fault | None = None

    @property
    def exit_status(self) -> int:
        """Return the exit status of the process; a stopped mission counts as failed: 1."""
        return {"success": 0, "failure": 1, "stopped": 1, "fault": 3}[self.outcome]


def timings_from(durations_ms: Mapping[str, Samples[float]]) -> dict[str, dict[str, float]]:
    """Return median, 95th percentile and number of each stage's wall times [ms]."""
    return {
        stage: {
            "median": round(float(np.median(list(values))), 3),
            "p95": round(float(np.percentile(list(values), 95)), 3),
            "n": values.total,
        }
        for stage, values in sorted(durations_ms.items())
        if values
    }


def cpu_s() -> float:
    """Return the processor time of this process so far, and of its children that have ended [s]."""
    spent = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in spent)


def resources_since(begun_cpu_s: float) -> dict[str, float]:
    """Return the processor time of a run [s] and the largest resident memory [byte].

    The memory is that of this process since it began, and that of its largest child so far.

    Args:
        begun_cpu_s: What `cpu_s` returned when the run began.
    """
    own, children = (
        resource.getrusage(who).ru_maxrss
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return {
        "cpu_s": round(cpu_s() - begun_cpu_s, 3),
        "peak_memory_bytes": (own + children) * _MAXRSS_BYTES,
    }


def write_report(path: Path, report: Mapping[str, Any]) -> None:
    """Write the report as JSON, whole or not at all."""
    partial = path.with_suffix(".partial")
    partial.write_text(
        json.dumps(plain(report), indent=2, ensure_ascii=False) + "\n", encoding="utf-8"
    )
    partial.replace(path)


def summary(report: Mapping[str, Any]) -> str:
    """Say in a few lines what came of the run."""
    counts = report["counts"]
    lines = [
        f"{report['mission']} (seed {report['seed']}): {report['outcome']}"
        + (f" – {report['reason']}" if report["reason"] else ""),
        f"  time       {_minutes(report['ended_s'])} on the mission's clock, "
        f"{_minutes(report['wall_s'])} on the wall"
        f" ({report['real_time_factor']:.1f} times real time)",
    ]
    if counts["picks"]:
        lines.append(
            f"  stones     {counts['placed']} of {counts['picks']} placed,"
            f" {counts['first_attempt']} at the first attempt ({counts['attempts']} attempts,"
            f" {counts['slips']} slips, {counts['drops']} drops, {counts['set_aside']} set aside)"
        )
    if counts["picks"] and "unseen" in counts:  # reports of older runs do not tell
        lines.append(
            f"             {counts['placed'] - counts['unseen']} seen at their place,"
            f" {counts['unseen']} not looked at after the release, {counts['off']} off,"
            f" {counts.get('lost', 0)} lost,"
            f" {counts['untouched']} of {counts['known']} known ones untouched"
        )
    if counts.get("turn_unknown"):
        lines.append(
            f"             {counts['turn_unknown']} placed by another surface than they were found"
            " with: how they had turned over is not known"
        )
    if counts.get("unverified"):
        lines.append(
            f"             {counts['unverified']} released, not verified: the mission ended before"
            " it looked"
        )
    for one in report.get("structures", ()):
        told = f"{len(one['standing'])} stones; it ended with {one['reason']}"
        lines.append(f"  structure  {one['structure']}: {told}, {one['detail']}")
    if counts["registrations"]:
        lines.append(
            f"  drone map  {counts['registrations_accepted']} of "
            f"{counts['registrations']} registrations accepted"
        )
    if counts["plugin_failures"]:
        lines.append(f"  plugins    {counts['plugin_failures']} errors passed over (log.txt)")
    lines += [
        f"  figure     {name} = {one['value']:g} {one['unit']}".rstrip()
        for name, one in report.get("figures", {}).items()
    ]
    lines += _time_lines(report)
    lines += [
        f"  ignored    {count} observations of type {kind}: no plugin takes them"
        for kind, count in report["ignored_observations"].items()
    ]
    lines += _truth_lines(report.get("truth"))
    return "\n".join(lines)


def _time_lines(report: Mapping[str, Any]) -> list[str]:
    """Say how often the mission was paused, and whether the loop kept its period."""
    pauses, late = report.get("pauses", {}), report.get("late_ticks", {})
    lines = []
    if pauses.get("count"):
        lines.append(
            f"  paused     {pauses['count']} times, {_minutes(pauses['wall_s'])} on the wall"
        )
    if late.get("count"):
        lines.append(f"  late       {late['count']} ticks, the worst by {late['worst_s']:.2f} s")
    return lines


def _truth_lines(truth: Mapping[str, Any] | None) -> list[str]:
    if not truth:
        return []
    lines = [f"  physics    {truth['scenario']}"] if "scenario" in truth else []
    errors = [s["slot_error_m"] for s in truth["stones"] if s.get("slot_error_m") is not None]
    if errors:
        near = sum(error <= NEAR_M for error in errors)
        lines.append(
            f"  truth      {near} of {len(errors)} within {NEAR_M:.2f} m of their slot"
            f" (median {np.median(errors):.2f} m, worst {max(errors):.2f} m), "
            f"{len(truth['collisions'])} collisions"
        )
    if truth.get("estimate"):
        error = truth["estimate"]["error_m"]
        lines.append(
            f"  estimate   {1e3 * error['mean']:.0f} mm off on average, "
            f"{1e3 * error['max']:.0f} mm at worst"
        )
    return lines


def _minutes(seconds: float) -> str:
    return f"{int(seconds // 60)}:{seconds % 60:04.1f} min"
