"""Simulated outages: measurements of a sensor that are left out for some time."""

from dataclasses import dataclass

from executive.errors import ConfigError
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

_KINDS = {
    ImuSample: "imu",
    GnssFix: "gnss",
    JointSample: "joints",
    LidarScan: "lidar",
    LidarIncrement: "lidar",
}


@dataclass(frozen=True, slots=True)
class Drop:
    """An outage of a sensor.

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
            ConfigError: If the text has another form, or the end is not after the beginning.
        """
        sensor, *times = text.rsplit(":", 2)
        try:
            from_s, to_s = (float(time) for time in times)
        except ValueError:
            raise ConfigError(
                f"--drop: '{text}' is not SENSOR:FROM:TO in seconds, such as gnss:120:165"
            ) from None
        if not from_s < to_s:
            raise ConfigError(f"--drop: '{text}' ends before it begins")
        return cls(sensor, from_s, to_s)

    def takes(self, observation: Observation | LidarIncrement) -> bool:
        """Return whether an observation is in the outage."""
        stamp_s = (
            observation.to_s if isinstance(observation, LidarIncrement) else observation.stamp_s
        )
        return self.from_s <= stamp_s < self.to_s and is_of(observation, self.sensor)


def is_of(observation: Observation | LidarIncrement, sensor: str) -> bool:
    """Return whether an observation is of a sensor, given by its kind or its frame's name."""
    return sensor in (_KINDS[type(observation)], _name_of(observation))


def _name_of(observation: Observation | LidarIncrement) -> str:
    if isinstance(observation, GnssFix):
        return observation.antenna
    return "" if isinstance(observation, JointSample) else observation.frame
