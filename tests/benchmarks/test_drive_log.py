"""Estimators on a recorded drive: errors against RTK, and what outages of the satellites cost on inertia alone.

Run with `pytest tests/benchmarks/test_drive_log.py -s`; it needs the shared drive log beside the project.
"""

from pathlib import Path

import numpy as np
import pytest

from executive.estimate.compare import table
from executive.estimate.run import Material, Options, estimate

LOG = Path(__file__).parents[3] / "shared" / "data" / "estimation" / "drive_0708.mcap"
ESTIMATORS = ("gnss_imu_filter", "error_state_ekf")


def outages(duration_s):
    return [f"gnss:{start}:{start + duration_s}" for start in range(80, 520, 40)]


@pytest.mark.skipif(not LOG.exists(), reason="the shared drive log is not there")
def test_a_drive() -> None:
    reports = {name: estimate(Material.read(LOG, Options()), name, Options()).report for name in ESTIMATORS}
    print("\n" + table(reports))
    for report in reports.values():
        assert report["posterior_m"]["std"] < 0.010
        assert report["prediction_m"]["p95"] < 0.05


@pytest.mark.skipif(not LOG.exists(), reason="the shared drive log is not there")
@pytest.mark.parametrize(("duration_s", "most_m"), [(5, 0.7), (10, 4.0)])
def test_outages(duration_s, most_m) -> None:
    options = Options(drops=outages(duration_s))
    report = estimate(Material.read(LOG, options), ESTIMATORS[0], options).report
    ends = np.array([outage["error_at_end_m"] for outage in report["outages"]])
    print(f"\n{duration_s} s without satellites, n = {len(ends)}: median {np.median(ends):.2f}, max {ends.max():.2f} m")
    assert np.median(ends) < most_m
