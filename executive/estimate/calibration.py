"""What is known of the sensors of a log beyond its transforms: a file, and its application."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError

from executive.config import Settings
from executive.errors import ConfigError, did_you_mean
from executive.estimate.offset import Offset
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.plain_yaml import read_plain_yaml

Vector = tuple[float, float, float]
_OF_STREAM = ("stamp_late_s", "stamp_std_s", "covariance_scale")  # not of the sensor's description


class SensorCalibration(Settings):
    """What was found of one sensor; what is None stays as the log or the machine declares it."""

    stamp_late_s: float | None = Field(
        None, ge=-2, le=2, description="Stamps minus times of measurement [s]."
    )
    stamp_std_s: float | None = Field(
        None, ge=0, le=2, description="Standard deviation of that [s]."
    )
    covariance_scale: float | None = Field(
        None, gt=0, le=1e4, description="Factor on the covariance that measurements declare."
    )
    xyz_m: Vector | None = Field(None, description="Place in the link that carries it [m].")
    rpy_rad: Vector | None = Field(None, description="Roll, pitch, yaw in that link [rad].")
    rate_hz: float | None = Field(None, gt=0, description="Samples a second [Hz].")
    gyro_noise_rad_s: float | None = Field(
        None, ge=0, description="Standard deviation of a sample [rad/s]."
    )
    accel_noise_m_s2: float | None = Field(
        None, ge=0, description="Standard deviation of a sample [m/s²]."
    )
    gyro_walk_rad_s: float | None = Field(
        None, ge=0, description="Random walk of the bias in one second [rad/s]."
    )
    accel_walk_m_s2: float | None = Field(
        None, ge=0, description="Random walk of the bias in one second [m/s²]."
    )

    @property
    def description(self) -> Mapping[str, Any]:
        """The fields of the sensor's description that were found."""
        return self.model_dump(exclude_none=True, exclude=set(_OF_STREAM))


class Calibration(Settings):
    """A calibration file, as `executive calibrate` writes it."""

    api: Literal[1] = Field(1, description="Version of the file's format.")
    log: str = Field("", description="The recording that it was found from.")
    sensors: dict[str, SensorCalibration] = Field(
        default_factory=dict, description="What was found, by the sensors' frames."
    )

    def applied(self, rig: Rig) -> Rig:
        """Return a rig with the mounting and the noise that were found.

        Raises:
            ConfigError: If the rig has no sensor of a name, or the sensor is of another kind.
        """
        if not self.sensors:
            return rig
        sensors = dict(rig.sensors)
        for name, found in self.sensors.items():
            sensor = sensors.get(name)
            if sensor is None:
                hint = did_you_mean(name, list(sensors))
                raise ConfigError(f"calibration: {rig.name} has no sensor '{name}'{hint}")
            try:
                sensors[name] = type(sensor).model_validate(
                    sensor.model_dump() | dict(found.description)
                )
            except ValidationError as error:
                first = error.errors()[0]
                field = ".".join(map(str, first["loc"]))
                raise ConfigError(
                    f"calibration: sensors.{name}.{field}: {first['msg']}; '{name}' is of the kind "
                    f"{sensor.kind}"
                ) from None
        return rig.model_copy(update={"sensors": sensors})

    @property
    def offsets(self) -> Sequence[Offset]:
        """What is added to the stamps of each sensor."""
        return tuple(
            Offset(name, -one.stamp_late_s)
            for name, one in self.sensors.items()
            if one.stamp_late_s is not None
        )

    def scaled(self, observation: Observation | LidarIncrement) -> Observation | LidarIncrement:
        """Return an observation with the covariance that was found; itself if none was."""
        if isinstance(observation, GnssFix):
            factor = self._scale(observation.antenna)
            covariance = factor * observation.covariance_enu_m2
            return (
                observation if factor == 1 else replace(observation, covariance_enu_m2=covariance)
            )
        if isinstance(observation, LidarIncrement):
            factor = self._scale(observation.frame)
            covariance = factor * observation.covariance
            return observation if factor == 1 else replace(observation, covariance=covariance)
        return observation

    def _scale(self, name: str) -> float:
        one = self.sensors.get(name)
        return 1.0 if one is None or one.covariance_scale is None else one.covariance_scale

    def clock_std_s(self, antennas: Collection[str]) -> float | None:
        """Return how far the antennas' clocks may still be off [s]; None if one was not found."""
        stds = [self.sensors[name].stamp_std_s for name in antennas if name in self.sensors]
        known = [std for std in stds if std is not None]
        return max(known) if known and len(known) == len(antennas) else None


def read_calibration(path: Path) -> Calibration:
    """Read a calibration file.

    Raises:
        ConfigError: If it cannot be read, or a field is unknown or wrong; the message names it.
    """
    document = read_plain_yaml(path)
    try:
        return Calibration.model_validate(document)
    except ValidationError as error:
        lines = [f"{path}: {'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors()]
        raise ConfigError("\n".join(lines)) from None
