"""Both odometries through a yard: turning, travelling, with gaps, blind scans and a jump."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.odometry.kiss_icp import KissIcp
from executive_plugins.odometry.scan_to_submap import ScanToSubmap
from executive_plugins.odometry.settings import KissIcpSettings, ScanToSubmapSettings

from executive.messages.lidar import LidarScan

# The iterations stop at a tolerance of their own.
RELATIVE = 1e-6


def thinned(scan: LidarScan, every: int) -> LidarScan:
    return LidarScan(
        scan.stamp_s, scan.frame, scan.points_lidar[::every], scan.point_stamps_s[::every]
    )


def driven(odometry, yard, every: int = 3) -> list[object]:
    odometry.start()
    told: list[object] = []
    for k in range(1, 11):
        t = 0.2 * k + (2.5 if k > 8 else 0.0)
        for sample in np.arange(t - 0.2, t + 0.01, 0.02):
            odometry.add_imu(yard.imu(float(sample)))
        odometry.add_joints(yard.joints(t))
        scan = thinned(yard.scan(t), every)
        if k == 5:  # blind
            scan = LidarScan(t, scan.frame, scan.points_lidar[:9], scan.point_stamps_s[:9])
        if k == 7:  # of another place
            scan = LidarScan(t, scan.frame, scan.points_lidar * 1.7, scan.point_stamps_s)
        told.append(odometry.add_scan(scan))
    told.append(odometry.add_scan(scan))  # twice
    told.append(odometry.add_scan(replace(scan, frame="lidar_vertical")))
    return told


@pytest.mark.parametrize(("rate", "speed"), [(0.0, 0.0), (0.6, 0.0), (0.3, 1.0)])
def test_scan_to_submap(recorded, yard, rate, speed) -> None:
    place = yard(rate_rad_s=rate, speed_m_s=speed)
    settings = ScanToSubmapSettings(key_distance_m=0.2, key_scans=3, restart_after=1)
    recorded(driven(ScanToSubmap(settings, place.machine), place), relative=RELATIVE)


@pytest.mark.parametrize(("rate", "speed"), [(0.0, 0.0), (0.3, 1.0)])
def test_kiss_icp(recorded, yard, rate, speed) -> None:
    place = yard(rate_rad_s=rate, speed_m_s=speed)
    settings = KissIcpSettings(max_speed_m_s=3.0)
    recorded(driven(KissIcp(settings, place.machine), place), relative=RELATIVE)


@pytest.mark.parametrize("made", [(KissIcp, KissIcpSettings), (ScanToSubmap, ScanToSubmapSettings)])
def test_other_sensors(recorded, yard, made) -> None:
    odometry, settings = made
    place = yard()
    stranger = odometry(settings(frame="nobody"), place.machine)
    stranger.start()
    stranger.add_imu(place.imu(0.1))
    stranger.add_joints(place.joints(0.1))
    known = [odometry.settings_for(names) for names in (("a", "b"), ("a", "lidar_horizontal"))]
    recorded((stranger.add_scan(place.scan(0.2)), known))
