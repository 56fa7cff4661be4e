"""Parts of the report of one run, and the report in a few lines for a person."""

import resource
import sys
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from executive.events.mission import Fault
from executive.events.site import BuildingEnded
from executive.interfaces.report import Counts, MissionOutcome, MissionReport, Resources, Timing
from executive.interfaces.truth import TrueStructure, Truth
from executive.mission.record.samples import Samples

NEAR_M = 0.30  # a stone within this distance of its slot, by the truth, counts as placed
_CAUSES = 3  # of late ticks that the summary names
_MAXRSS_BYTES = 1 if sys.platform == "darwin" else 1024  # unit of getrusage's resident memory


@dataclass(frozen=True, slots=True)
class Ending:
    """How a run ended.

    Attributes:
        outcome: success, failure, stopped or fault.
        reason: Why, for a person.
        fault: What failed, if an error of a plugin or leaf ended the run.
    """

    outcome: MissionOutcome
    reason: str
    fault: Fault | None = None

    @property
    def is_fault(self) -> bool:
        """Whether an error of a plugin or leaf, or a watched condition, ended the run."""
        return self.outcome == "fault"

    @property
    def exit_status(self) -> int:
        """Return the exit status of the process; a stopped mission counts as failed: 1."""
        return {"success": 0, "failure": 1, "stopped": 1, "fault": 3}[self.outcome]


def timings_from(durations_ms: Mapping[str, Samples[float]]) -> dict[str, Timing]:
    """Return median, 95th percentile and number of each stage's wall times [ms]."""
    return {
        stage: Timing(
            median=round(float(np.median(list(values))), 3),
            p95=round(float(np.percentile(list(values), 95)), 3),
            n=values.total,
        )
        for stage, values in sorted(durations_ms.items())
        if values
    }


def cpu_s() -> float:
    """Return the processor time of this process so far, and of its children that have ended [s]."""
    spent = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in spent)


def resources_since(begun_cpu_s: float, compiling_s: float) -> Resources:
    """Return the processor time of a run [s] and the largest resident memory [byte].

    The memory is that of this process since it began, and that of its largest child so far.

    Args:
        begun_cpu_s: What `cpu_s` returned when the run began.
        compiling_s: Processor time of compiling in this process since then [s].
    """
    own, children = (
        resource.getrusage(who).ru_maxrss
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return Resources(
        round(cpu_s() - begun_cpu_s, 3), (own + children) * _MAXRSS_BYTES, round(compiling_s, 3)
    )


def summary(report: MissionReport) -> str:
    """Say in a few lines what came of the run."""
    reason = f" – {report.reason}" if report.reason else ""
    lines = [
        f"{report.mission} (seed {report.seed}): {report.outcome}{reason}",
        f"  time       {_minutes(report.ended_s)} on the mission's clock, "
        f"{_minutes(report.wall_s)} on the wall"
        f" ({report.real_time_factor:.1f} times real time)",
        *_stone_lines(report.counts),
        *_other_lines(report),
        *_time_lines(report),
    ]
    lines += [
        f"  ignored    {count} observations of type {kind}: no plugin takes them"
        for kind, count in report.ignored_observations.items()
    ]
    return "\n".join(lines + _truth_lines(report.truth))


def _stone_lines(counts: Counts) -> list[str]:
    """Say how many stones were placed, and where the others are."""
    if not counts.picks:
        return []
    lines = [
        f"  stones     {counts.placed} of {counts.picks} placed,"
        f" {counts.first_attempt} at the first attempt ({counts.attempts} attempts,"
        f" {counts.slips} slips, {counts.drops} drops, {counts.set_aside} set aside)",
        f"             {counts.placed - counts.unseen} seen at their place,"
        f" {counts.unseen} not looked at after the release, {counts.off} off,"
        f" {counts.lost} lost,"
        f" {counts.untouched} of {counts.known} known ones untouched",
    ]
    if counts.turn_unknown:
        lines.append(
            f"             {counts.turn_unknown} placed by another surface than they were found"
            " with: how they had turned over is not known"
        )
    if counts.unverified:
        lines.append(
            f"             {counts.unverified} released, not verified: the mission ended before"
            " it looked"
        )
    return lines


def _structure_lines(ended: BuildingEnded) -> list[str]:
    """Say how a structure ended, and why each stone that is left has no place."""
    lines = [
        f"  structure  {ended.structure}: {len(ended.standing)} stones; it ended with"
        f" {ended.reason}, {ended.detail}"
    ]
    for stone, refused in ended.by_stone.items():
        told = ", ".join(f"{n} × {reason}" for reason, n in refused.items())
        lines.append(f"             stone {stone} has no place: {told}")
    return lines


def _other_lines(report: MissionReport) -> list[str]:
    """Say what was built, registered and measured, and which plugins failed."""
    counts = report.counts
    lines = [line for one in report.structures for line in _structure_lines(one)]
    if counts.registrations:
        lines.append(
            f"  drone map  {counts.registrations_accepted} of "
            f"{counts.registrations} registrations accepted"
        )
    if counts.plugin_failures:
        lines.append(f"  plugins    {counts.plugin_failures} errors passed over (log.txt)")
    lines += [
        f"  figure     {name} = {one.value:g} {one.unit}".rstrip()
        for name, one in report.figures.items()
    ]
    return lines


def _time_lines(report: MissionReport) -> list[str]:
    """Say how often the mission was paused, and whether the loop kept its period."""
    pauses, late = report.pauses, report.late_ticks
    lines = []
    if pauses is not None and pauses.count:
        lines.append(f"  paused     {pauses.count} times, {_minutes(pauses.wall_s)} on the wall")
    if late is not None and late.count:
        told = f"  late       {late.count} ticks, the worst by {late.worst_s:.2f} s"
        lines.append(f"{told}, for {late.worst_cause}" if late.worst_cause else told)
        often = [f"{cause} ({count})" for cause, count in list(late.causes.items())[:_CAUSES]]
        lines += [f"             most often for {', '.join(often)}"] if often else []
    return lines


def _truth_lines(truth: Truth | None) -> list[str]:
    if truth is None:
        return []
    standing = ""
    if truth.stance:
        tilt_deg = np.degrees(truth.stance.most_tilt_rad)
        standing = f", on its legs, tilted by {tilt_deg:.1f}° at most"
    lines = [f"  physics    {truth.scenario}{standing}"]
    errors = [one.slot_error_m for one in truth.stones if one.slot_error_m is not None]
    if errors:
        near = sum(error <= NEAR_M for error in errors)
        collisions = "" if truth.collisions is None else f", {len(truth.collisions)} collisions"
        lines.append(
            f"  truth      {near} of {len(errors)} within {NEAR_M:.2f} m of their slot"
            f" (median {np.median(errors):.2f} m, worst {max(errors):.2f} m){collisions}"
        )
    for one in truth.structures:
        lines += _standing_lines(one)
    if truth.estimate:
        error = truth.estimate.error_m
        lines.append(
            f"  estimate   {1e3 * error.mean:.0f} mm off on average, "
            f"{1e3 * error.max:.0f} mm at worst"
        )
    return lines


def _standing_lines(structure: TrueStructure) -> list[str]:
    """Say what really stands of a structure, and each figure of its judge."""
    moved = max(structure.moved_m, default=0.0)
    lines = [
        f"  standing   {structure.name}: {len(structure.stones)} stones over its foot, moved by"
        f" {moved:.2f} m at most since they were placed"
    ]
    told = [f"{name} {value:.2f}" for name, value in structure.verdict.items() if value is not None]
    if told:
        lines.append(f"  judge      {', '.join(told)}")
    elif structure.stones:
        lines.append("  judge      no verdict; if there is a judge, log.txt tells why")
    return lines


def _minutes(seconds: float) -> str:
    return f"{int(seconds // 60)}:{seconds % 60:04.1f} min"
