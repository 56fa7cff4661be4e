"""Fixes that contradict a filter: the reported covariance holds both, until one has given way."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter

from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.messages.gnss import GnssFix

DATUM = np.array([47.4084, 8.5106, 440.0])
FROM_S, UNTIL_S, OFF_M = 7.0, 8.0, np.array([5.0, 0.0, 0.0])


def jumped(fix: GnssFix) -> GnssFix:
    """Return a fix that is five metres off."""
    p = enu_from_geodetic(fix.geodetic, DATUM) + OFF_M
    return replace(fix, geodetic=geodetic_from_enu(p, DATUM))


@pytest.mark.parametrize("kind", [GnssImuFilter, ErrorStateEkf])
@pytest.mark.parametrize("clock_std_s", [0.0, 0.05])
def test_the_covariance_holds_fixes_that_are_refused_and_no_longer_once_they_agree(
    machine, cabin, kind, clock_std_s: float
) -> None:
    estimator = kind(kind.Settings(datum=tuple(DATUM), clock_std_s=clock_std_s), machine)
    estimator.start()
    std_m, off_m = {}, {}
    for observation in cabin.observations(9.0):
        if isinstance(observation, GnssFix) and FROM_S <= observation.stamp_s < UNTIL_S:
            observation = jumped(observation)
        estimator.add(observation)
        state = estimator.state()
        R = state.T_map_cabin[:3, :3]
        std_m[state.stamp_s] = np.sqrt(np.diag(R @ state.covariance[3:, 3:] @ R.T))
        off = state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3]
        off_m[state.stamp_s] = np.linalg.norm(off)
    during = [t for t in std_m if FROM_S + 0.3 < t < UNTIL_S]
    assert max(off_m[t] for t in during) < 0.1  # the fixes are refused
    assert min(std_m[t][0] for t in during) > 3.0
    assert max(std_m[t][1] for t in during) < 0.5  # across the jump nothing is in doubt
    before = [t for t in std_m if 6.0 < t < FROM_S]
    after = [t for t in std_m if t > UNTIL_S + 0.5]
    assert max(std_m[t].max() for t in (*before, *after)) < 0.1
