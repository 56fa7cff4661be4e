"""Estimators side by side on one log: Tables I and II of Nubert 2022, and what else one run tells."""

from collections.abc import Mapping, Sequence
from typing import Any

from executive.estimate.run import Material, Options, estimate


def compare(material: Material, names: Sequence[str], options: Options) -> dict[str, dict[str, Any]]:
    """Return the report of each estimator by name.

    Raises:
        ConfigError, DataError: As `estimate`.
    """
    return {name: estimate(material, name, options).report for name in names}


def table(reports: Mapping[str, Mapping[str, Any]]) -> str:
    """Lay the reports side by side: errors in centimetres, latencies in microseconds."""
    rows = {
        "position error when given out [cm]": lambda r: _mean_std(r["prediction_m"], 100),
        "  95 % [cm]": lambda r: _figure(r["prediction_m"], "p95", 100),
        "position error after the fix [cm]": lambda r: _mean_std(r["posterior_m"], 100),
        "consistency [cm]": lambda r: _mean_std(r["consistency_m"], 100),
        "latency of an inertial sample [µs]": lambda r: _mean_std(r["latency_us"], 1),
        "  99 % [µs]": lambda r: _figure(r["latency_us"], "p99", 1),
        "replay, times real time": lambda r: f"{r['replay_speed']:.0f}",
    }
    lines = [["", *reports], *[[title, *map(cell, reports.values())] for title, cell in rows.items()]]
    first = next(iter(reports.values()))
    for i, outage in enumerate(first["outages"]):
        title = f"outage {outage['from_s']:.0f}–{outage['to_s']:.0f} s, {outage['way_m']:.0f} m: at its end [m]"
        lines.append([title, *[_at_end(report, i) for report in reports.values()]])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join([line[0].ljust(widths[0]), *_right(line[1:], widths[1:])]) for line in lines)


def _right(cells: Sequence[str], widths: Sequence[int]) -> list[str]:
    return [cell.rjust(width) for cell, width in zip(cells, widths, strict=True)]


def _mean_std(figures: Mapping[str, float], factor: float) -> str:
    return f"{factor * figures['mean']:.2f} ± {factor * figures['std']:.2f}" if figures["n"] else "-"


def _figure(figures: Mapping[str, float], name: str, factor: float) -> str:
    return f"{factor * figures[name]:.2f}" if figures["n"] else "-"


def _at_end(report: Mapping[str, Any], i: int) -> str:
    return f"{report['outages'][i]['error_at_end_m']:.2f}" if i < len(report["outages"]) else "-"
