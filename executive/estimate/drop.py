"""Outages made on purpose: sensors that are left out for some time."""

from dataclasses import dataclass

from executive.errors import ConfigError
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

_KINDS = {ImuSample: "imu", GnssFix: "gnss", JointSample: "joints", LidarScan: "lidar", LidarIncrement: "lidar"}


@dataclass(frozen=True, slots=True)
class Drop:
    """A sensor's outage.

    Attributes:
        sensor: A kind (imu, gnss, joints, lidar), or the name of one sensor's frame.
        from_s: Its beginning, since the log's first message [s].
        to_s: Its end [s].
    """

    sensor: str
    from_s: float
    to_s: float

    @classmethod
    def parse(cls, text: str) -> "Drop":
        """Read `SENSOR:FROM:TO`.

        Raises:
            ConfigError: If it is written otherwise, or does not end after it begins.
        """
        sensor, *times = text.rsplit(":", 2)
        try:
            from_s, to_s = (float(time) for time in times)
        except ValueError:
            raise ConfigError(f"--drop: '{text}' is not SENSOR:FROM:TO in seconds, such as gnss:120:165") from None
        if not from_s < to_s:
            raise ConfigError(f"--drop: '{text}' ends before it begins")
        return cls(sensor, from_s, to_s)

    def takes(self, observation: Observation | LidarIncrement) -> bool:
        """Return whether an observation falls into the outage."""
        if isinstance(observation, LidarIncrement):
            stamp_s, name = observation.to_s, observation.frame
        else:
            stamp_s = observation.stamp_s
            name = _sensor_of(observation)
        return self.sensor in (_KINDS[type(observation)], name) and self.from_s <= stamp_s < self.to_s


def _sensor_of(observation: Observation) -> str:
    if isinstance(observation, GnssFix):
        return observation.antenna
    return "" if isinstance(observation, JointSample) else observation.frame
