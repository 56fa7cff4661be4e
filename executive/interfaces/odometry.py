"""Lidar odometry: scans to pose increments."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

from executive.interfaces.plugin import Plugin
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement


class LidarOdometry(Plugin, ABC):
    """Estimate how the lidar moved from one scan to the next (Nubert 2022, Sec. IV-A4)."""

    capability = "odometry"

    @classmethod
    def settings_for(cls, lidars: Sequence[str]) -> Mapping[str, object]:
        """Return the settings for a rig, by the names of the fields of `Settings`.

        Args:
            lidars: Names of the rig's lidars, at least one.
        """
        return {}

    @abstractmethod
    def add_scan(self, scan: LidarScan) -> LidarIncrement | None:
        """Match one scan with those before it; called in order of arrival, within the tick.

        Returns:
            The motion of the sensor since the scan that it was matched with, or None: for the
            first scan, an empty one, one out of order, one of another sensor, after a long silence,
            and where the match is not to be trusted.
        """

    def add_imu(self, sample: ImuSample) -> None:
        """Take an inertial sample, to undistort scans by; all samples up to a scan's stamp come
        before it.
        """

    def add_joints(self, sample: JointSample) -> None:
        """Take a joint sample, to undistort scans by and to know the machine's own returns."""
