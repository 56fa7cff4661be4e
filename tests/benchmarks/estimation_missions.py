"""Lay the estimators side by side on simulated missions with a swinging cabin: tables, and the plot
of the outages.

    python tests/benchmarks/estimation_missions.py 1 2 3
    python tests/benchmarks/estimation_missions.py 1 --plot docs/images/estimation_outages.png

Each seed is run once and recorded; scans become increments once. Three conditions are cut from that
log: all sensors; outages of the satellites of 45 s and 160 s; and the same with nothing that tells
that the chassis stands (its inertial sensor is left out), so that lidar alone carries the estimate.
Ten minutes a seed on an idle core.
"""

import argparse
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from executive.commands.recorded_mission import Rehearsal, rehearse
from executive.estimate.compare import reported, table
from executive.estimate.drop import Drop
from executive.estimate.estimator_run import estimate
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions
from executive.messages.base_state import BaseState

ESTIMATORS = ("dual_graph", "error_state_ekf", "gnss_imu_filter")
MISSION = Path(__file__).with_name("swing.yaml")
OUTAGES = ("gnss:30:75", "gnss:79:239")
UNWATCHED = "imu_base:0:9999"
CONDITIONS: Mapping[str, Sequence[str]] = {
    "all sensors": (),
    "satellites lost for 45 s and 160 s": OUTAGES,
    "the same, and nothing tells that the chassis stands": (*OUTAGES, UNWATCHED),
}
WINDOW_S = 0.5  # of a point in the plot


def recorded(seed: int, folder: Path) -> tuple[Rehearsal, Material]:
    """Run the mission and read its log."""
    rehearsal = rehearse(str(MISSION), (), seed, folder)
    material = Material.read(rehearsal.log, EstimateOptions(odometry="scan_to_submap"))
    return rehearsal, replace(material, datum=np.array(rehearsal.datum))


def curve(rehearsal: Rehearsal, states: Sequence[BaseState]) -> np.ndarray:
    """Return times [s] and mean distances from the truth [m], window by window, shape (2, n)."""
    windows: dict[int, list[BaseState]] = {}
    for state in states:
        windows.setdefault(int(state.stamp_s / WINDOW_S), []).append(state)
    errors = [rehearsal.truth(window)["error_m"]["mean"] for window in windows.values()]
    return np.array([(np.array(list(windows)) + 0.5) * WINDOW_S, errors])


def compared(
    rehearsal: Rehearsal, material: Material, seed: int
) -> Mapping[str, Mapping[str, np.ndarray]]:
    """Print a table for each condition, and return the curves of each estimator."""
    curves: dict[str, dict[str, np.ndarray]] = {}
    for title, drops in CONDITIONS.items():
        cut = replace(material, drops=tuple(map(Drop.parse, drops)))
        reports = {}
        for name in ESTIMATORS:
            estimated = estimate(cut, name, EstimateOptions(odometry="scan_to_submap"))
            reports[name] = reported(estimated, rehearsal.truth)
            curves.setdefault(title, {})[name] = curve(rehearsal, estimated.replay.states)
        print(f"\nseed {seed}: {title}\n{table(reports)}", flush=True)
    return curves


def plot(path: Path, curves: Mapping[str, Mapping[str, np.ndarray]]) -> None:
    """Draw the distance from the truth over time through both outages, with and without a watched
    chassis.
    """
    figure = Figure(figsize=(11, 6), layout="constrained")
    for axes, (title, by_name) in zip(
        figure.subplots(2, 1, sharex=True), list(curves.items())[1:], strict=True
    ):
        for name, (stamps_s, errors_m) in by_name.items():
            axes.semilogy(stamps_s, errors_m, linewidth=1, label=name)
        for drop in map(Drop.parse, OUTAGES):
            axes.axvspan(drop.from_s, drop.to_s, color="0.92")
        axes.set(ylabel="distance from the truth [m]", title=title)
        axes.legend(loc="upper left", fontsize="small")
    axes.set(xlabel="time [s]; outages in grey")
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seeds", type=int, nargs="+")
    parser.add_argument("--plot", type=Path, help="PNG of the first seed's outages")
    arguments = parser.parse_args()
    for seed in arguments.seeds:
        with tempfile.TemporaryDirectory() as folder:
            rehearsal, material = recorded(seed, Path(folder))
            curves = compared(rehearsal, material, seed)
        if arguments.plot is not None and seed == arguments.seeds[0]:
            plot(arguments.plot, curves)
            print(arguments.plot, file=sys.stderr)


if __name__ == "__main__":
    main()
