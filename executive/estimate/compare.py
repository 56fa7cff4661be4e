"""Estimators compared on one log: Tables I and II of Nubert 2022, and further measures."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import DataError
from executive.estimate.estimator_run import Estimated, estimate
from executive.estimate.material import Material
from executive.estimate.measures import Track
from executive.estimate.options import EstimateOptions
from executive.messages.base_state import BaseState

# Errors of estimated states by a simulator's truth: `error_m` and `error_rad`, each with mean, std
# and max of the magnitude; `error_m` may also have the bias and the std of a component.
Truth = Callable[[Sequence[BaseState]], Mapping[str, Mapping[str, float]]]


def compare(
    material: Material, names: Sequence[str], options: EstimateOptions, truth: Truth | None = None
) -> dict[str, dict[str, Any]]:
    """Return the report of each estimator by name.

    Args:
        material: The log.
        names: Names of the estimators.
        options: Options of the runs.
        truth: Errors of states against a simulator's truth; None if the truth is unknown.

    Returns:
        The report of each; {"error": why} for an estimator that gave none while another did.

    Raises:
        ConfigError: As `estimate`.
        DataError: As `estimate`, if there is no report at all.
    """
    return side_by_side(names, lambda name: reported(estimate(material, name, options), truth))


def side_by_side(
    names: Sequence[str], run: Callable[[str], dict[str, Any]]
) -> dict[str, dict[str, Any]]:
    """Return a report for each name; a run that finds no state does not end the others.

    Raises:
        DataError: If there is no report at all.
    """
    reports: dict[str, dict[str, Any]] = {}
    failures: list[DataError] = []
    for name in names:
        try:
            reports[name] = run(name)
        except DataError as error:
            failures.append(error)
            reports[name] = {"error": str(error)}
    if failures and len(failures) == len(reports):
        raise failures[0]
    return reports


def reported(estimated: Estimated, truth: Truth | None = None) -> dict[str, Any]:
    """Return the report of one run, with steps of the odometry frame and recovery after outages."""
    return estimated.report | {
        "odometry_step_m": round(float(odometry_steps(estimated.track).max(initial=0.0)), 5),
        "outages": [
            _with_recovery(outage, estimated, truth) for outage in estimated.report["outages"]
        ],
        "truth": dict(truth(estimated.replay.states)) if truth is not None else {},
    }


def odometry_steps(track: Track) -> Float:
    """Return how far the cabin moved in the odometry frame beyond v·dt, between samples [m].

    The shape is (n − 1,) for n states.
    """
    T_map_odom = track.T_map_odom
    p_odom = np.linalg.inv(T_map_odom) @ track.T_map_cabin[:, :, 3:]
    moved = np.einsum("nij,nj->ni", T_map_odom[1:, :3, :3], np.diff(p_odom[:, :3, 0], axis=0))
    even = 0.5 * (track.v_map_cabin[1:] + track.v_map_cabin[:-1]) * np.diff(track.stamps_s)[:, None]
    return np.asarray(np.linalg.norm(moved - even, axis=1))


def _with_recovery(
    outage: Mapping[str, Any], estimated: Estimated, truth: Truth | None
) -> dict[str, Any]:
    """Add the time until the estimator was GLOBAL again, and its largest error in the outage."""
    states = estimated.report["states"]
    begun = [state["status"] for state in states if state["time_s"] <= outage["to_s"]]
    back = [
        state["time_s"]
        for state in states
        if state["time_s"] > outage["to_s"] and state["status"] == "GLOBAL"
    ]
    recovered_s = (
        0.0 if begun and begun[-1] == "GLOBAL" else (back[0] - outage["to_s"] if back else None)
    )
    added: dict[str, Any] = {
        "recovered_after_s": None if recovered_s is None else round(recovered_s, 3)
    }
    within = [s for s in estimated.replay.states if outage["from_s"] <= s.stamp_s < outage["to_s"]]
    if truth is not None and within:
        added["truth"] = dict(truth(within)["error_m"])
    return {**outage, **added}


def table(reports: Mapping[str, Mapping[str, Any]]) -> str:
    """Return a table of the reports: errors in centimetres, latencies in microseconds.

    Estimators without a report are named below it, with the reason.
    """
    failed = [f"{name}: {r['error']}" for name, r in reports.items() if "error" in r]
    reports = {name: report for name, report in reports.items() if "error" not in report}
    rows: dict[str, Callable[[Mapping[str, Any]], str]] = {
        "position error of the prediction [cm]": lambda r: _mean_std(r["prediction_m"], 100),
        "  95 % [cm]": lambda r: _figure(r["prediction_m"], "p95", 100),
        "position error after the fix [cm]": lambda r: _mean_std(r["posterior_m"], 100),
        "consistency [cm]": lambda r: _mean_std(r["consistency_m"], 100),
        "latency of an inertial sample [µs]": lambda r: _mean_std(r["latency_us"], 1),
        "  99 % [µs]": lambda r: _figure(r["latency_us"], "p99", 1),
        "largest step of the odometry frame [cm]": lambda r: f"{100 * r['odometry_step_m']:.2f}",
        "replay, times real time": lambda r: f"{r['replay_speed']:.0f}",
    }
    if all(report["truth"] for report in reports.values()):
        rows = {
            "position error against the truth [cm]": lambda r: _mean_std(
                {"n": 1, **r["truth"]["error_m"]}, 100
            ),
            "  as bias ± std of a component": lambda r: _bias_std(r["truth"]["error_m"]),
            "  largest [cm]": lambda r: f"{100 * r['truth']['error_m']['max']:.2f}",
            "attitude error against the truth [mrad]": lambda r: _mean_std(
                {"n": 1, **r["truth"]["error_rad"]}, 1e3
            ),
        } | rows
    lines = [
        ["", *reports],
        *[[title, *map(cell, reports.values())] for title, cell in rows.items()],
    ]
    lines += [line for i in range(_outages(reports)) for line in _outage_lines(reports, i)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    rows_of_text = [
        "  ".join([line[0].ljust(widths[0]), *_right(line[1:], widths[1:])]) for line in lines
    ]
    return "\n".join([*rows_of_text, *failed])


def _outages(reports: Mapping[str, Mapping[str, Any]]) -> int:
    return min(len(report["outages"]) for report in reports.values())


def _outage_lines(reports: Mapping[str, Mapping[str, Any]], i: int) -> list[list[str]]:
    """Return the lines on one outage: errors at its end and at most, and time of recovery."""
    outages = [report["outages"][i] for report in reports.values()]
    first = outages[0]
    title = (
        f"outage {first['from_s']:.0f}–{first['to_s']:.0f} s, "
        f"distance travelled {first['way_m']:.0f} m:"
    )
    lines = [
        [title, *[""] * len(outages)],
        [
            "  at its end, against the fixes [m]",
            *[f"{outage['error_at_end_m']:.2f}" for outage in outages],
        ],
        ["  largest [m]", *[f"{outage['max_error_m']:.2f}" for outage in outages]],
        [
            "  GLOBAL again after [s]",
            *[_seconds(outage["recovered_after_s"]) for outage in outages],
        ],
    ]
    if all("truth" in outage for outage in outages):
        lines.insert(
            3, ["  largest, against the truth [m]", *[f"{o['truth']['max']:.3f}" for o in outages]]
        )
    return lines


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _right(cells: Sequence[str], widths: Sequence[int]) -> list[str]:
    return [cell.rjust(width) for cell, width in zip(cells, widths, strict=True)]


def _mean_std(figures: Mapping[str, float], factor: float) -> str:
    return (
        f"{factor * figures['mean']:.2f} ± {factor * figures['std']:.2f}" if figures["n"] else "-"
    )


def _bias_std(figures: Mapping[str, float]) -> str:
    """Return bias ± standard deviation of a component [cm], as Nubert 2022, Table I."""
    return (
        f"{100 * figures['bias']:.2f} ± {100 * figures['component_std']:.2f}"
        if "bias" in figures
        else "-"
    )


def _figure(figures: Mapping[str, float], name: str, factor: float) -> str:
    return f"{factor * figures[name]:.2f}" if figures["n"] else "-"
