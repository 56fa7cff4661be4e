"""Estimators side by side on simulated missions with a swinging cabin."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from matplotlib import figure as plots

from executive.commands.logs.recorded_mission import RecordedMission, record_mission
from executive.estimate.compare import reported, table
from executive.estimate.drop import Drop
from executive.estimate.estimator_run import estimate
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions, log_choices
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
HELD = "dual_graph"  # the bounds are for this estimator; the others stand beside it
WAY = 0.007  # of an outage: its error may be this share of the way

Reports = Mapping[str, Mapping[str, Any]]  # condition → estimator → report
Curves = Mapping[str, Mapping[str, np.ndarray]]


def recorded(seed: int, folder: Path) -> tuple[RecordedMission, Material]:
    """Run the mission and read its log."""
    rehearsal = record_mission(str(MISSION), (), seed, folder)
    material = Material.read(
        rehearsal.log, EstimateOptions(plugins=log_choices(odometry="scan_to_submap"))
    )
    return rehearsal, replace(material, datum=np.array(rehearsal.datum))


def curve(rehearsal: RecordedMission, states: Sequence[BaseState]) -> np.ndarray:
    """Return times [s] and mean distances from the truth [m], window by window, shape (2, n)."""
    windows: dict[int, list[BaseState]] = {}
    for state in states:
        windows.setdefault(int(state.stamp_s / WINDOW_S), []).append(state)
    errors = [rehearsal.truth(window)["error_m"]["mean"] for window in windows.values()]
    return np.array([(np.array(list(windows)) + 0.5) * WINDOW_S, errors])


def compared(rehearsal: RecordedMission, material: Material, seed: int) -> tuple[Reports, Curves]:
    """Print a table for each condition, and return the reports and curves of each estimator."""
    curves: dict[str, dict[str, np.ndarray]] = {}
    by_condition: dict[str, dict[str, Any]] = {}
    for title, drops in CONDITIONS.items():
        cut = replace(material, drops=tuple(map(Drop.parse, drops)))
        reports = {}
        for name in ESTIMATORS:
            estimated = estimate(
                cut, name, EstimateOptions(plugins=log_choices(odometry="scan_to_submap"))
            )
            reports[name] = reported(estimated, rehearsal.truth)
            curves.setdefault(title, {})[name] = curve(rehearsal, estimated.replay.states)
        by_condition[title] = reports
        print(f"\nseed {seed}: {title}\n{table(reports)}", flush=True)
    return by_condition, curves


def plot(path: Path, curves: Mapping[str, Mapping[str, np.ndarray]]) -> None:
    """Draw the distance from the truth over time through both outages, with and without a watched
    chassis.
    """
    figure = plots.Figure(figsize=(11, 6), layout="constrained")
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


def figures(seed: int, reports: Reports) -> Iterator[Figure]:
    """Yield the figures of the estimator that is held to the bounds of Nubert 2022, Table I."""
    clean, lost, unwatched = (reports[title][HELD] for title in CONDITIONS)
    error, consistency = clean["truth"]["error_m"], clean["consistency_m"]
    whose = f"{HELD}, seed {seed}"
    for what, metres, bound in (
        ("position error, bias [cm]", error["bias"], Bound(0.18, 0.15)),
        ("position error, std of a component [cm]", error["component_std"], Bound(1.28, 0.6)),
        ("consistency, mean [cm]", consistency["mean"], Bound(0.58, 0.3)),
        ("consistency, std [cm]", consistency["std"], Bound(3.16, 0.5)),
    ):
        yield held(f"{whose}: {what}", 100 * metres, bound)
    for title, report in (("", lost), (", chassis unwatched", unwatched)):
        yield held(
            f"{whose}{title}: odometry frame, step beyond v·dt [cm]",
            100 * report["odometry_step_m"],
            Bound(1.0, 0.2),
        )
        for outage in report["outages"]:
            seconds, back_s = outage["to_s"] - outage["from_s"], outage["recovered_after_s"]
            name = f"{whose}{title}, outage of {seconds:.0f} s"
            share = outage["truth"]["max"] / outage["way_m"]
            yield held(f"{name}: largest error [% of way]", 100 * share, Bound(100 * WAY))
            yield held(
                f"{name}: GLOBAL again after [s]",
                np.inf if back_s is None else back_s,
                Bound(1.5, 1.0),
            )
