"""Three estimators on a recorded drive: errors against RTK, outages, and the speed of a replay.

Outages are spread evenly over the drive, each of them a gap of the satellites that the estimator
goes through while it runs on; several passes, shifted against one another, make more of them. Speed
is in processor seconds, with and without the reading of the log.
"""

import hashlib
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held

from executive.estimate.drop import Drop
from executive.estimate.estimator_run import Estimated, estimate
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions, log_choices

FIRST_S, LAST_S = 60.0, 520.0  # outages begin after the start and before the end of the drive
PERIODS_S = {5: 40.0, 10: 40.0}  # from one outage to the next, by their length
ROWS = {
    "posterior": ("after a fix, against RTK: std [cm]", Bound(1.0, 0.5)),
    "prediction": ("prediction over 250 ms: 95 % [cm]", Bound(5.0, 4.0)),
    "refused": ("good fixes refused [%]", Bound(0.5, 0.0)),
    "alarms": ("states left without cause", Bound(0)),
    "outage 5": ("outage of 5 s: median, largest [m]", Bound(0.7, 0.3)),
    "outage 10": ("outage of 10 s: median, largest [m]", Bound(3.0, 1.2)),
    "replay": ("replay, times real time", Bound(50, 150, is_least=True)),
    "whole": ("the same with reading", None),
    "repeat": ("runs that differ in a bit", Bound(0)),
}
HELD = "dual_graph"  # the bounds are for this estimator; the others stand beside it

Cells = dict[str, tuple[float, str]]  # the value that is held against the bound, and its words


class Drive:
    """A log that was read once, with what is put right of its stamps.

    Attributes:
        reading_s: Processor time that reading took [s].
    """

    def __init__(self, path: Path, offsets: Sequence[str]) -> None:
        started_s = time.process_time()
        options = EstimateOptions(offsets=offsets, plugins=log_choices(odometry="scan_to_submap"))
        self._material = Material.read(path, options)
        self.reading_s = time.process_time() - started_s

    def run(self, name: str, drops: Sequence[str] = ()) -> tuple[Estimated, float]:
        """Return what came of one run, and the processor time that it took [s]."""
        material = replace(self._material, drops=tuple(map(Drop.parse, drops)))
        started_s = time.process_time()
        estimated = estimate(material, name, EstimateOptions(drops=drops))
        return estimated, time.process_time() - started_s

    def outages(self, name: str, duration_s: int, shifts: int) -> list[float]:
        """Return the errors at the ends of outages [m]."""
        period_s, ends = PERIODS_S[duration_s], []
        for shift in range(shifts):
            starts = np.arange(FIRST_S + shift * period_s / shifts, LAST_S, period_s)
            estimated, _ = self.run(name, [f"gnss:{t}:{t + duration_s}" for t in starts])
            ends += [outage["error_at_end_m"] for outage in estimated.report["outages"]]
            print(
                f"{name}: {duration_s} s, n = {len(ends)}: median {np.median(ends):.2f} m",
                file=sys.stderr,
            )
        return ends


def column(drive: Drive, name: str, shifts: int) -> Cells:
    """Return an estimator's cells."""
    first, _ = drive.run(name)  # this one compiles and fills caches, so the next is timed
    second, estimating_s = drive.run(name)
    report = first.report
    refused = sum(
        n
        for reason, n in report["refused"].items()
        if reason.endswith(("outlier", "during recovery"))
    )
    last_fix_s = first.errors.stamps_s[-1]
    values = {
        "posterior": 100 * report["posterior_m"]["std"],
        "prediction": 100 * report["prediction_m"]["p95"],
        "refused": 100 * refused / report["counts"]["GnssFix"],
        "alarms": sum(s["time_s"] < last_fix_s for s in report["states"][2:]),
        "replay": report["duration_s"] / estimating_s,
        "whole": report["duration_s"] / (estimating_s + drive.reading_s),
        "repeat": int(_digest(first) != _digest(second)),
    }
    cells = {key: (value, f"{value:.2f}") for key, value in values.items()}
    print(name, cells, file=sys.stderr)  # what there is of a run that is interrupted later
    for duration_s in PERIODS_S:
        ends = drive.outages(name, duration_s, shifts)
        words = f"{np.median(ends):.2f}, {max(ends):.2f} (n = {len(ends)})"
        cells[f"outage {duration_s}"] = float(np.median(ends)), words
    return cells


def _digest(estimated: Estimated) -> str:
    return hashlib.sha256(estimated.track.T_map_base.tobytes()).hexdigest()


def table(columns: Mapping[str, Cells]) -> str:
    """Lay the columns side by side, in Markdown: bold misses its bound, a star marks a stretch."""
    lines = [["", *columns, "must", "stretch"], ["---"] * (len(columns) + 3)]
    for key, (label, bound) in ROWS.items():
        limits = ["", ""]
        if bound is not None:
            limits = [str(bound), "" if bound.stretch is None else f"{bound.stretch:g}"]
        lines.append([label, *[_marked(cells[key], bound) for cells in columns.values()], *limits])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _marked(cell: tuple[float, str], bound: Bound | None) -> str:
    value, words = cell
    if bound is None:
        return words
    if not bound.holds(value):
        return f"**{words}**"
    return f"{words} ★" if bound.is_stretched(value) else words


def figures(columns: Mapping[str, Cells]) -> list[Figure]:
    """Return the figures of `dual_graph`, or of the first estimator where that one is left out."""
    name = HELD if HELD in columns else next(iter(columns))
    return [
        held(f"{name}: {label}", columns[name][key][0], bound, columns[name][key][1])
        for key, (label, bound) in ROWS.items()
        if bound is not None
    ]
