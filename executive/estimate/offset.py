"""Constant errors of a sensor's stamps, by an unsynchronised clock or a filter delay."""

from dataclasses import dataclass, replace

from executive.errors import ConfigError
from executive.estimate.drop import is_of
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement


@dataclass(frozen=True, slots=True)
class Offset:
    """A time that is added to the stamps of a sensor.

    Attributes:
        sensor: A kind (imu, gnss, joints, lidar), or the name of one sensor's frame.
        seconds: The time that is added [s].
    """

    sensor: str
    seconds: float

    @classmethod
    def parse(cls, text: str) -> "Offset":
        """Read `SENSOR:SECONDS`.

        Raises:
            ConfigError: If the text has another form.
        """
        sensor, colon, seconds = text.rpartition(":")
        try:
            return cls(sensor, float(seconds if colon and sensor else "none"))
        except ValueError:
            raise ConfigError(
                f"--offset: '{text}' is not SENSOR:SECONDS, such as gnss:0.05"
            ) from None

    def applied(self, observation: Observation | LidarIncrement) -> Observation | LidarIncrement:
        """Return an observation with its stamps shifted, or itself if it is of another sensor."""
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
