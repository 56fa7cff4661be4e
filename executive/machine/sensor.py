"""Sensors of the machine: their mounting, rate, latency and noise."""

from typing import Annotated, Literal

from pydantic import Field

from executive.arrays import Float
from executive.machine.origin import Origin
from executive.machine.provenance import Sourced


class _Mounted(Sourced, Origin):
    name: str = Field(description="Unique name; also the name of its frame.")
    link: str = Field(description="Link that carries it.")
    rate_hz: float = Field(gt=0, description="Samples or revolutions a second [Hz].")
    latency_s: float = Field(0.0, ge=0, lt=1, description="Time from stamp to arrival [s].")
    age_periods: float = Field(
        3.0, ge=1, le=1000, description="Periods without a good sample until it counts as lost."
    )
    may_repeat: bool = Field(
        False, description="Whether equal values in a row are usual, as of a coarse encoder."
    )

    @property
    def age_limit_s(self) -> float:
        """Age of the newest good sample from which on the sensor counts as lost [s]."""
        return self.latency_s + self.age_periods / self.rate_hz

    @property
    def T_link_sensor(self) -> Float:
        """Pose of the sensor in its link, shape (4, 4)."""
        return self.T


class Lidar(_Mounted):
    """A spinning lidar that turns about its z axis; azimuth 0 is along x."""

    kind: Literal["lidar"]
    lasers: int = Field(gt=0, le=128, description="Number of lasers, evenly spaced in elevation.")
    elevation_rad: tuple[float, float] = Field(
        description="Elevation of the lowest and highest laser [rad]."
    )
    azimuth_step_rad: float = Field(gt=0, lt=0.2, description="Angle between two firings [rad].")
    range_m: tuple[float, float] = Field(description="Nearest and farthest return [m].")
    range_noise_m: float = Field(ge=0, description="Standard deviation of a range [m].")


class Imu(_Mounted):
    """An inertial measurement unit."""

    kind: Literal["imu"]
    gyro_range_rad_s: float = Field(
        8.7, gt=0, description="Largest angular velocity that it measures [rad/s]."
    )
    accel_range_m_s2: float = Field(
        78.0, gt=0, description="Largest specific force that it measures [m/s²]."
    )
    gyro_noise_rad_s: float = Field(ge=0, description="Standard deviation of a sample [rad/s].")
    gyro_bias_rad_s: float = Field(
        ge=0, description="Standard deviation of the bias at the start [rad/s]."
    )
    gyro_walk_rad_s: float = Field(
        ge=0, description="Bias random walk in one second, standard deviation [rad/s]."
    )
    accel_noise_m_s2: float = Field(ge=0, description="Standard deviation of a sample [m/s²].")
    accel_bias_m_s2: float = Field(
        ge=0, description="Standard deviation of the bias at the start [m/s²]."
    )
    accel_walk_m_s2: float = Field(
        ge=0, description="Bias random walk in one second, standard deviation [m/s²]."
    )


class Gnss(_Mounted):
    """One RTK antenna, whose phase centre is the frame's origin."""

    kind: Literal["gnss"]
    horizontal_noise_m: float = Field(gt=0, description="Standard deviation east and north [m].")
    vertical_noise_m: float = Field(gt=0, description="Standard deviation up [m].")


class Encoders(_Mounted):
    """All joint encoders and cylinder pressures as one sensor."""

    kind: Literal["encoders"]
    angle_noise_rad: float = Field(ge=0, description="Standard deviation of an angle [rad].")
    length_noise_m: float = Field(
        ge=0, description="Standard deviation of a prismatic joint's position [m]."
    )
    velocity_noise: float = Field(
        ge=0, description="Standard deviation of a velocity [rad/s] or [m/s]."
    )
    effort_noise: float = Field(
        ge=0, lt=1, description="Standard deviation of an effort, as a share of its limit."
    )


Sensor = Annotated[Lidar | Imu | Gnss | Encoders, Field(discriminator="kind")]
