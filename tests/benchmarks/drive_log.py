"""Lay three estimators side by side on a recorded drive: errors against RTK, outages on inertia
alone, speed of replay.

    python tests/benchmarks/drive_log.py LOG.mcap
    python tests/benchmarks/drive_log.py LOG.mcap --estimators dual_graph --shifts 1
    python tests/benchmarks/drive_log.py LOG.mcap --offset gnss:0.08

Without LOG it takes the shared drive beside the project. Outages are spread evenly over the drive,
each of them a gap of the satellites that the estimator goes through while it runs on; several
passes, shifted against one another, make more of them. Speed is in processor seconds, with and
without the reading of the log. Bold is a must that is missed, a star a stretch that is reached.
"""

import argparse
import hashlib
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from executive.estimate.drop import Drop
from executive.estimate.estimator_run import Estimated, estimate
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions

LOG = Path(__file__).parents[3] / "shared" / "data" / "estimation" / "drive_0708.mcap"
ESTIMATORS = ("dual_graph", "error_state_ekf", "gnss_imu_filter")
FIRST_S, LAST_S = (
    60.0,
    520.0,
)  # when outages may begin: the estimators have begun, and the drive has not ended
PERIODS_S = {5: 40.0, 10: 40.0}  # from one outage to the next, by their length


@dataclass(frozen=True, slots=True)
class Row:
    """One figure, what it must be and what was hoped for; speeds are lower bounds."""

    label: str
    must: float | None = None
    stretch: float | None = None
    is_least: bool = False

    def marked(self, value: float, text: str) -> str:
        sign = -1 if self.is_least else 1
        if self.must is not None and sign * value > sign * self.must:
            return f"**{text}**"
        return text + (
            " ★" if self.stretch is not None and sign * value <= sign * self.stretch else ""
        )


ROWS = {
    "posterior": Row("after a fix, against RTK: std [cm]", 1.0, 0.5),
    "prediction": Row("prediction over 250 ms: 95 % [cm]", 5.0, 4.0),
    "refused": Row("good fixes refused [%]", 0.5, 0.0),
    "alarms": Row("states left without cause", 0),
    "outage 5": Row("outage of 5 s: median, largest [m]", 0.7, 0.3),
    "outage 10": Row("outage of 10 s: median, largest [m]", 3.0, 1.2),
    "replay": Row("replay, times real time", 50, 150, is_least=True),
    "whole": Row("the same with reading"),
    "repeat": Row("to the bit on repeat", 0),
}


class Drive:
    """A log that was read once, with what is put right of its stamps.

    Attributes:
        reading_s: Processor time that reading took [s].
    """

    def __init__(self, path: Path, offsets: Sequence[str]) -> None:
        started_s = time.process_time()
        options = EstimateOptions(offsets=offsets, odometry="scan_to_submap")
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


def column(drive: Drive, name: str, shifts: int) -> dict[str, str]:
    """Return an estimator's cells."""
    (first, _), (second, estimating_s) = (
        drive.run(name),
        drive.run(name),
    )  # the first one compiles and fills caches
    report = first.report
    refused = sum(
        n
        for reason, n in report["refused"].items()
        if reason.endswith(("outlier", "not yet believed"))
    )
    last_fix_s = first.errors.stamps_s[-1]
    figures = {
        "posterior": 100 * report["posterior_m"]["std"],
        "prediction": 100 * report["prediction_m"]["p95"],
        "refused": 100 * refused / report["counts"]["GnssFix"],
        "alarms": sum(s["time_s"] < last_fix_s for s in report["states"][2:]),
        "replay": report["duration_s"] / estimating_s,
        "whole": report["duration_s"] / (estimating_s + drive.reading_s),
        "repeat": int(_digest(first) != _digest(second)),
    }
    cells = {key: ROWS[key].marked(value, f"{value:.2f}") for key, value in figures.items()}
    cells["repeat"] = "no" if figures["repeat"] else "yes"
    print(name, cells, file=sys.stderr)  # of a run that is broken off, what there is
    for duration_s in PERIODS_S:
        ends = drive.outages(name, duration_s, shifts)
        text = f"{np.median(ends):.2f}, {max(ends):.2f} (n = {len(ends)})"
        cells[f"outage {duration_s}"] = ROWS[f"outage {duration_s}"].marked(
            float(np.median(ends)), text
        )
    return cells


def _digest(estimated: Estimated) -> str:
    return hashlib.sha256(estimated.track.T_map_base.tobytes()).hexdigest()


def table(columns: Mapping[str, Mapping[str, str]]) -> str:
    """Lay the columns side by side, in Markdown."""
    lines = [["", *columns, "must", "stretch"], ["---"] * (len(columns) + 3)]
    for key, row in ROWS.items():
        bounds = ["" if bound is None else f"{bound:g}" for bound in (row.must, row.stretch)]
        bounds = ["yes", ""] if key == "repeat" else bounds
        lines.append([row.label, *[cells[key] for cells in columns.values()], *bounds])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("log", type=Path, nargs="?", default=LOG)
    parser.add_argument("--estimators", default=",".join(ESTIMATORS))
    parser.add_argument(
        "--shifts", type=int, default=2, help="passes of outages, shifted against one another"
    )
    parser.add_argument("--offset", action="append", default=[], metavar="SENSOR:SECONDS")
    arguments = parser.parse_args()
    drive = Drive(arguments.log, tuple(arguments.offset))
    print(
        table(
            {
                name: column(drive, name, arguments.shifts)
                for name in arguments.estimators.split(",")
            }
        )
    )


if __name__ == "__main__":
    main()
