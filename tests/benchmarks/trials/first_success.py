"""When the drone's map is first registered in the mapping mission.

Times are the mission's, from the first movement of the swing.
"""

import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.surveying import simulated_drone

from executive.arrays import Float
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

HEADER = "seed  dense_s  first_s attempts matched stones  error_mm"


class Witness:
    """Keep the true points of the last survey, and the same points in the survey's own frame."""

    def __init__(self) -> None:
        self.pair: tuple[Float, Float] | None = None
        self._drawn = simulated_drone.own_frame
        simulated_drone.own_frame = self._own_frame  # type: ignore[assignment]

    def _own_frame(self, points_map: Float, *rest: Any) -> Float:
        told = self._drawn(points_map, *rest)
        self.pair = points_map, told
        return told

    def error_m(self, registration: dict) -> float:
        """Return the distance of the survey's middle from its true place [m]."""
        T = np.array(registration["T_map_survey"])
        there, told = self.pair
        return float(
            np.linalg.norm(
                ((registration["scale"] * told @ T[:3, :3].T + T[:3, 3]) - there).mean(axis=0)
            )
        )


def line(journal: list[dict], witness: Witness, seed: int) -> tuple[str, float, float]:
    """Return a line for people, the time of the first success [s] (inf if none) and its
    error [m].
    """
    tried = [entry for entry in journal if entry["kind"] == "survey_registered"]
    dense = [entry for entry in journal if entry["kind"] == "map_dense"]
    stones = [
        len(entry["payload"]["stones"]) for entry in journal if entry["kind"] == "site_segmented"
    ]
    accepted = [entry for entry in tried if entry["payload"]["accepted"]]
    dense_s = dense[0]["payload"]["waited_s"] if dense else np.nan
    if not accepted or not dense:
        return f"{seed:4d} {dense_s:8.1f} {'-':>8} {len(tried):8d}", np.inf, np.inf
    first_s = accepted[0]["time_s"] - dense[0]["time_s"] + dense_s
    error_m = witness.error_m(accepted[0]["payload"])
    matched = accepted[0]["payload"]["matched_segments"]
    text = (
        f"{seed:4d} {dense_s:8.1f} {first_s:8.1f} {len(tried):8d} {matched:7d} "
        f"{stones[-1]:6d} {1e3 * error_m:9.0f}"
    )
    return text, first_s, error_m


def measured(
    seeds: Sequence[int], overrides: Sequence[str] = ()
) -> tuple[list[float], list[float]]:
    """Run the mission over seeds; return when each first succeeded [s] and how far it was off [m],
    inf if never.
    """
    times, errors, witness = [], [], Witness()
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            run_dir = Path(folder) / str(seed)
            made = Run(load_mission("map_site", overrides), Options(seed=seed, run_dir=run_dir))
            made.execute(lambda mission: None)
            journal = [
                json.loads(row) for row in (run_dir / "journal.jsonl").read_text().splitlines()
            ]
            text, first_s, error_m = line(journal, witness, seed)
            print(text, flush=True)
            times.append(first_s)
            errors.append(error_m)
    return times, errors


def figures(times_s: Sequence[float], errors_m: Sequence[float]) -> list[Figure]:
    """Hold the worst seed against the bounds."""
    early = ", ".join(
        f"{np.mean(np.array(times_s) <= limit):.0%} after {limit} s" for limit in (5, 10, 15)
    )
    print(f"first success: median {np.median(times_s):.1f} s; {early}, of {len(times_s)}")
    print(f"error: median {1e3 * np.median(errors_m):.0f} mm")
    return [
        held("first success after scanning for, worst [s]", max(times_s), Bound(10.0, 5.0)),
        held("error of the survey's middle, worst [mm]", 1e3 * max(errors_m), Bound(50.0)),
    ]
