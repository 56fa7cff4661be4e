"""Filters over streams with faults: late, wrong, missing and repeated samples."""

from dataclasses import replace

import pytest
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings, GnssImuSettings

from executive.errors import ConfigError
from executive.messages.odometry import LidarIncrement

# A filter sums up thousands of samples: velocities differ by 1e-9 m/s between two processors.
ROUNDING = 1e-8
SHORT = {"rest": {"duration_s": 0.5}, "restart_after_s": 1.0}


def test_gnss_imu_filter(recorded, machine, faulty, followed) -> None:
    settings = GnssImuSettings(**SHORT, reacquire_after_s=2, fallback_after_s=0.5)
    recorded(followed(GnssImuFilter(settings, machine), faulty), absolute=ROUNDING)


def test_error_state_ekf(recorded, machine, faulty, followed) -> None:
    settings = ErrorStateEkfSettings(**SHORT, odometry_scale=2.0, lag_s=0.2)
    recorded(followed(ErrorStateEkf(settings, machine), faulty), absolute=ROUNDING)


def test_increments_of_an_unknown_sensor_are_refused(recorded, machine, stream, followed) -> None:
    stream = [
        replace(one, frame="imu_base") if isinstance(one, LidarIncrement) else one for one in stream
    ]
    with pytest.raises(ConfigError) as refused:
        followed(ErrorStateEkf(ErrorStateEkfSettings(**SHORT), machine), stream)
    recorded(refused.value)
