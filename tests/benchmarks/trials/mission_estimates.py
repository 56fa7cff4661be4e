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
_BIAS, _DEVIATION = Bound(0.18, 0.1), Bound(1.28, 0.6)  # [cm], Nubert et al. 2022, Table I


def measured(seed: int, is_driving: bool) -> Mapping[str, float]:
    """Return errors of one mission [m]: `bias` and `component_std` of the position, `map_bias` and
    `map_std` of the map's points, and `map_median` of their distances to the true surface.
    """
    mission = _DRIVE if is_driving else "map_site"
    with TemporaryDirectory() as folder:
        recorded = record_mission(mission, (), seed, Path(folder))
        report = compare_on(recorded, [_ESTIMATOR], EstimateOptions())[_ESTIMATOR]
        run = json.loads((Path(folder) / "run" / "report.json").read_text())
    errors, on_map = report["truth"]["error_m"], run["truth"]["map"]
    found = {
        "bias": errors["bias"],
        "component_std": errors["component_std"],
        "map_bias": abs(on_map["bias_m"]),
        "map_std": on_map["std_m"],
        "map_median": on_map["distance_m"]["median"],
    }
    print(
        f"seed {seed}: position {100 * found['bias']:.2f} ± {100 * found['component_std']:.2f} cm "
        f"in {report['duration_s']:.0f} s, map {100 * on_map['bias_m']:.2f} ± "
        f"{100 * found['map_std']:.2f} cm, distance {100 * found['map_median']:.2f} cm",
        flush=True,
    )
    return found


def figures(missions: Sequence[Mapping[str, float]]) -> list[Figure]:
    """Return the worst figures of all missions against the bounds, and the median."""
    rows = []
    kinds = (
        ("bias of the position", "bias", _BIAS),
        ("deviation of the position", "component_std", _DEVIATION),
        ("bias of the map, without its sign", "map_bias", _BIAS),
        ("deviation of the map", "map_std", _DEVIATION),
    )
    for what, key, bound in kinds:
        values = 100 * np.array([one[key] for one in missions])
        words = f"{np.median(values):.2f} ({values.min():.2f} to {values.max():.2f})"
        about = f"{what}, the largest counts; median (range) [cm]"
        rows.append(held(about, float(values.max()), bound, words))
    return rows
