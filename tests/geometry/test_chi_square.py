"""Quantiles of the chi-square distribution, against scipy's, and what they are there for."""

import subprocess
import sys

import pytest
from scipy.stats import chi2

from executive.geometry import chi_square


@pytest.mark.parametrize("degrees", [1, 2, 3, 6, 7.5, 150, 9000])
def test_quantiles_are_those_of_scipy_to_the_bit(degrees: float) -> None:
    for share in (1e-12, 1e-9, 0.003, 0.5, 0.95, 0.9999):
        assert chi_square.quantile(share, degrees) == chi2.ppf(share, degrees)
        assert chi_square.bound(share, degrees) == chi2.isf(share, degrees)
    assert chi_square.median(degrees) == chi2.median(degrees)


def test_what_a_mission_watches_and_estimates_with_does_not_import_all_of_scipy_stats() -> None:
    program = (
        "import sys, executive.mission.guard, executive_plugins.estimation.filters.gnss_imu_filter;"
        "sys.exit('scipy.stats' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0
