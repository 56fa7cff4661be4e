"""Fixes that err by one vector for seconds: the covariance holds it, as it holds what scatters."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter

from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.messages.gnss import GnssFix

DATUM = np.array([47.4084, 8.5106, 440.0])
STD_M, OFF_M = 0.5, np.array([0.5, -0.4, 0.3])


def as_float(fix: GnssFix, rng: np.random.Generator, is_slow: bool) -> GnssFix:
    """Return a fix that declares half a metre, and errs by as much, slowly or from fix to fix."""
    off = OFF_M if is_slow else rng.normal(0, STD_M, 3)
    p = enu_from_geodetic(fix.geodetic, DATUM) + off
    return replace(
        fix, geodetic=geodetic_from_enu(p, DATUM), covariance_enu_m2=STD_M**2 * np.eye(3)
    )


@pytest.mark.parametrize("kind", [GnssImuFilter, ErrorStateEkf])
@pytest.mark.parametrize("clock_std_s", [0.0, 0.05])
@pytest.mark.parametrize("is_slow", [True, False])
def test_the_covariance_holds_what_does_not_average_out(
    machine, cabin, kind, clock_std_s: float, is_slow: bool
) -> None:
    settings = {"datum": tuple(DATUM), "clock_std_s": clock_std_s, "clock_agrees": 0.5}
    estimator = kind(kind.Settings(**settings), machine)
    estimator.start()
    rng = np.random.default_rng(3)
    for observation in cabin.observations(14.0):
        is_fix = isinstance(observation, GnssFix)
        if isinstance(observation, GnssFix) and observation.stamp_s > 7.0:
            observation = as_float(observation, rng, is_slow)
        if not (is_fix and 5.0 < observation.stamp_s < 7.0):
            estimator.add(observation)
    state = estimator.state()
    std_m = np.sqrt(np.trace(state.covariance[3:, 3:]))
    if is_slow:
        off = state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3]
        R = state.T_map_cabin[:3, :3]
        nees = off @ np.linalg.solve(R @ state.covariance[3:, 3:] @ R.T, off)
        assert nees < 14.2  # three standard deviations
        assert std_m > 0.2
    else:
        assert std_m < 0.2  # 280 independent fixes
