"""Missions whose base is free to move, and how far estimate and map were from the truth."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from bounds import Bound, Figure, held

from executive.commands.logs.recorded_mission import compare_on, record_mission
from executive.estimate.options import EstimateOptions

_ESTIMATOR = "gnss_imu_filter"  # of the shipped missions
_DRIVE = str(Path(__file__).with_name("drive_and_scan.yaml"))
_SAID = "bias", "component_std", "map_median", "map_p95"
_BIAS, _DEVIATION = Bound(0.18, 0.1), Bound(1.28, 0.6)  # [cm], Nubert et al. 2022, Table I


def measured(seed: int, is_driving: bool) -> Mapping[str, float]:
    """Return errors of one mission [m]: of the position `bias` and `component_std`, of the map's
    points `map_median` and `map_p95`, which are distances to the true surface.
    """
    mission, settings = (_DRIVE, ()) if is_driving else ("map_site", ("robot.base=on_legs",))
    with TemporaryDirectory() as folder:
        recorded = record_mission(mission, settings, seed, Path(folder))
        report = compare_on(recorded, [_ESTIMATOR], EstimateOptions())[_ESTIMATOR]
        run = json.loads((Path(folder) / "run" / "report.json").read_text())
    on_map = run["truth"]["map"]["distance_m"]
    found = {**report["truth"]["error_m"], **{f"map_{key}": on_map[key] for key in on_map}}
    bias, deviation, median, p95 = (100 * found[key] for key in _SAID)
    print(
        f"seed {seed}: {bias:.2f} ± {deviation:.2f} cm in {report['duration_s']:.0f} s, "
        f"map {median:.2f} cm, 95 % {p95:.2f} cm",
        flush=True,
    )
    return found


def figures(missions: Sequence[Mapping[str, float]]) -> list[Figure]:
    """Return the worst figures of all missions against the bounds, and the median.

    A distance has no sign: its median over the points of a map is held against the bound of a bias.
    """
    rows = []
    kinds = (
        ("bias of the position", "bias", _BIAS),
        ("deviation of the position", "component_std", _DEVIATION),
        ("distance of the map from the true surface", "map_median", _BIAS),
    )
    for what, key, bound in kinds:
        values = 100 * np.array([one[key] for one in missions])
        words = f"{np.median(values):.2f} ({values.min():.2f} to {values.max():.2f})"
        about = f"{what}, the largest counts; median (range) [cm]"
        rows.append(held(about, float(values.max()), bound, words))
    return rows
