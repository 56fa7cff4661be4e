"""Missions whose base is free to move, and how far their estimate was from the truth."""

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
    """Return the errors of the position in one mission [m]: `bias` and `component_std`."""
    mission, settings = (_DRIVE, ()) if is_driving else ("map_site", ("robot.base=on_legs",))
    with TemporaryDirectory() as folder:
        recorded = record_mission(mission, settings, seed, Path(folder))
        report = compare_on(recorded, [_ESTIMATOR], EstimateOptions())[_ESTIMATOR]
    found: Mapping[str, float] = report["truth"]["error_m"]
    bias, deviation = 100 * found["bias"], 100 * found["component_std"]
    lasted_s = report["duration_s"]
    print(f"seed {seed}: {bias:.2f} ± {deviation:.2f} cm in {lasted_s:.0f} s", flush=True)
    return found


def figures(missions: Sequence[Mapping[str, float]]) -> list[Figure]:
    """Return the worst bias and deviation of all missions against the bounds, and the median."""
    rows = []
    for what, key, bound in (("bias", "bias", _BIAS), ("deviation", "component_std", _DEVIATION)):
        values = 100 * np.array([one[key] for one in missions])
        words = f"{np.median(values):.2f} ({values.min():.2f} to {values.max():.2f})"
        about = f"{what} of the position, the largest counts; median (range) [cm]"
        rows.append(held(about, float(values.max()), bound, words))
    return rows
