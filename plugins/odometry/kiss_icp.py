"""Lidar odometry by the KISS-ICP package, predicted by gyroscope and joints."""

from collections.abc import Mapping, Sequence

import numpy as np
from executive_plugins.odometry.dead_reckoning import DeadReckoning
from executive_plugins.odometry.own_returns import OwnReturns
from executive_plugins.odometry.settings import KissIcpSettings
from kiss_icp.config import KISSConfig
from kiss_icp.kiss_icp import KissICP

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.interfaces.odometry import LidarOdometry
from executive.machine.rig import Rig
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

_REVOLUTION_S = 0.1  # time over which the first scan is undistorted
_FEWEST = 100  # smallest number of points that are matched


class KissIcp(LidarOdometry):
    """KISS-ICP (Vizzo 2023, "KISS-ICP: In Defense of Point-to-Point ICP") with a better prediction.

    The machine's own returns are removed first. Deviation: the package predicts and undistorts by
    its last motion, which does not hold on a cabin that swings; here both come from dead reckoning.
    The package gives no covariance: that of an increment is a setting, independent of the scene. On
    level ground, the rings of a 16-laser lidar hold points at their place; `scan_to_submap` is more
    accurate there.
    """

    Settings = KissIcpSettings

    def __init__(self, settings: KissIcpSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    @classmethod
    def settings_for(cls, lidars: Sequence[str]) -> Mapping[str, object]:
        default = cls.Settings.model_fields["frame"].default
        return {} if default in lidars else {"frame": lidars[0]}

    def start(self) -> None:
        self._own = OwnReturns(self._machine)
        self._reckoning: DeadReckoning | None = None
        if self._settings.frame in self._machine.sensors:
            self._reckoning = DeadReckoning(self._machine, self._settings.frame)
        self._begin()

    def _begin(self) -> None:
        settings = self._settings
        # A complete description: the package would read missing values from the environment.
        self._kiss = KissICP(
            KISSConfig.model_validate(
                {
                    "data": {
                        "min_range": settings.near_m,
                        "max_range": settings.far_m,
                        "deskew": False,
                    },
                    "mapping": {
                        "voxel_size": settings.voxel_m,
                        "max_points_per_voxel": settings.points_per_voxel,
                    },
                    "registration": {"max_num_threads": 1},
                    "adaptive_threshold": {"initial_threshold": settings.first_threshold_m},
                }
            )
        )
        self._last: tuple[float, Float] | None = None

    def add_imu(self, sample: ImuSample) -> None:
        if self._reckoning is not None:
            self._reckoning.add_imu(sample)

    def add_joints(self, sample: JointSample) -> None:
        self._own.add_joints(sample)
        if self._reckoning is not None:
            self._reckoning.add_joints(sample)

    def add_scan(self, scan: LidarScan) -> LidarIncrement | None:
        if scan.frame != self._settings.frame or self._reckoning is None:
            return None
        if self._last is not None and scan.stamp_s - self._last[0] > self._settings.longest_gap_s:
            self._begin()
        last = self._last
        kept = ~self._own.among(scan)
        if int(kept.sum()) < _FEWEST or (last is not None and scan.stamp_s <= last[0]):
            return None
        from_s = scan.stamp_s - _REVOLUTION_S
        path = self._reckoning.path(from_s if last is None else min(from_s, last[0]), scan.stamp_s)
        if last is not None:
            self._kiss.last_delta = inverse(path.T_end_then(last[0]))
        points = path.undistort(scan.points_lidar[kept], scan.point_stamps_s[kept])
        self._kiss.register_frame(points, scan.point_stamps_s[kept])
        self._last = (scan.stamp_s, np.array(self._kiss.last_pose))
        return None if last is None else self._increment(last, self._last)

    def _increment(
        self, last: tuple[float, Float], now: tuple[float, Float]
    ) -> LidarIncrement | None:
        """Return the motion between two scans; None and a new map if it is implausible."""
        T_from_to = inverse(last[1]) @ now[1]
        if self._reckoning is None or not self._is_plausible(T_from_to, now[0] - last[0]):
            self._begin()
            return None
        increment = LidarIncrement(
            last[0], now[0], self._settings.frame, T_from_to, self._covariance()
        )
        self._reckoning.correct(increment)
        return increment

    def _is_plausible(self, T_from_to: Float, duration_s: float) -> bool:
        speed_m_s = float(np.linalg.norm(T_from_to[:3, 3])) / duration_s
        rate_rad_s = angle_between(np.eye(3), T_from_to[:3, :3]) / duration_s
        return (
            speed_m_s < self._settings.max_speed_m_s and rate_rad_s < self._settings.max_rate_rad_s
        )

    def _covariance(self) -> Float:
        std = np.repeat([self._settings.rotation_std_rad, self._settings.translation_std_m], 3)
        return np.asarray(np.diag(std**2))
