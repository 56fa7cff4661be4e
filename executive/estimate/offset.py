"""Sensors whose stamps are wrong by a constant: clocks that were not synchronised, filters that
delay.
"""

from dataclasses import dataclass, replace

from executive.errors import ConfigError
from executive.estimate.drop import is_of
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement


@dataclass(frozen=True, slots=True)
class Offset:
    """What is added to the stamps of a sensor.

    Attributes:
        sensor: A kind (imu, gnss, joints, lidar), or the name of one sensor's frame.
        seconds: [s].
    """

    sensor: str
    seconds: float

    @classmethod
    def parse(cls, text: str) -> "Offset":
        """Read `SENSOR:SECONDS`.

        Raises:
            ConfigError: If it is written otherwise.
        """
        sensor, colon, seconds = text.rpartition(":")
        try:
            return cls(sensor, float(seconds if colon and sensor else "none"))
        except ValueError:
            raise ConfigError(
                f"--offset: '{text}' is not SENSOR:SECONDS, such as gnss:0.05"
            ) from None

    def applied(self, observation: Observation | LidarIncrement) -> Observation | LidarIncrement:
        """Return an observation with its stamps moved, or as it is if it is of another sensor."""
        if not is_of(observation, self.sensor):
            return observation
        if isinstance(observation, LidarIncrement):
            return replace(
                observation,
                from_s=observation.from_s + self.seconds,
                to_s=observation.to_s + self.seconds,
            )
        if isinstance(observation, LidarScan):
            stamps_s = observation.point_stamps_s + self.seconds
            return replace(
                observation, stamp_s=observation.stamp_s + self.seconds, point_stamps_s=stamps_s
            )
        return replace(observation, stamp_s=observation.stamp_s + self.seconds)
