"""Noise of an inertial sensor as densities of white noise and random walks."""

from dataclasses import dataclass, field

import numpy as np

from executive.arrays import Float
from executive.machine.sensor import Imu


@dataclass(frozen=True, slots=True)
class InertialNoise:
    """Continuous-time noise of one inertial sensor.

    Attributes:
        gyro_density: Angular random walk [rad/√s].
        accel_density: Velocity random walk [m/s/√s].
        gyro_bias_walk: Random walk of the gyro's bias [rad/s/√s].
        accel_bias_walk: Random walk of the accelerometer's bias [m/s²/√s].
        accel_bias_m_s2: Bias of the accelerometer at switch-on [m/s²].
        gravity_m_s2: Local gravity, the scale of the specific force [m/s²].
        gyro_bias_rad_s: Bias of the gyroscope at switch-on [rad/s].
        densities: The first four in their order, shape (4,).
    """

    gyro_density: float
    accel_density: float
    gyro_bias_walk: float
    accel_bias_walk: float
    accel_bias_m_s2: float
    gravity_m_s2: float
    gyro_bias_rad_s: float
    densities: Float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        densities = (
            self.gyro_density,
            self.accel_density,
            self.gyro_bias_walk,
            self.accel_bias_walk,
        )
        object.__setattr__(self, "densities", np.array(densities))

    @classmethod
    def of(cls, imu: Imu, factor: float, gravity_m_s2: float) -> "InertialNoise":
        """Return the noise of a sensor's data sheet.

        Args:
            imu: The sensor.
            factor: Factor on the white noise, for vibration that a data sheet does not include.
            gravity_m_s2: Local gravity [m/s²].
        """
        seconds = imu.rate_hz**-0.5  # from the standard deviation of a sample to a density
        return cls(
            max(factor * imu.gyro_noise_rad_s * seconds, 1e-5),
            max(factor * imu.accel_noise_m_s2 * seconds, 1e-4),
            max(imu.gyro_walk_rad_s, 1e-6),
            max(imu.accel_walk_m_s2, 1e-5),
            max(imu.accel_bias_m_s2, 1e-3),
            gravity_m_s2,
            max(imu.gyro_bias_rad_s, 1e-4),
        )
