"""How a chassis that stands leans and sways, by its own gyroscope."""

import math

import numpy as np
from executive_plugins.estimation.gate.innovation_alarm import binary, chance_limit
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.machine.rig import Rig
from executive.machine.sensor import Imu


class ChassisSway:
    """Tells the turning of a chassis at rest from the bias of its gyroscope.

    A chassis on legs or tyres is at rest in the mean alone: it leans under its arm, and sways. Near
    the middle of a sway it turns at an even rate, which half a second of samples does not tell from
    the bias. That is the mean of all pieces of rest: a chassis leans one way as often as the other.

    Attributes:
        height_m: Of the cabin's origin above the feet about which the chassis sways [m].
    """

    def __init__(self, sensor: Imu, usual_rad_s: float, height_m: float) -> None:
        """Begin with the bias of the data sheet.

        Args:
            sensor: The chassis' inertial sensor.
            usual_rad_s: Standard deviation of the angular velocity of a chassis at rest [rad/s].
            height_m: See the attribute.
        """
        self._usual2, self._sensor, self.height_m = usual_rad_s**2, sensor, height_m
        self._bias, self._variance = np.zeros(3), sensor.gyro_bias_rad_s**2
        self._newest_s = -math.inf

    @classmethod
    def of(cls, rig: Rig, name: str, standing: StandstillSettings) -> "ChassisSway | None":
        """Return the sway of a rig's chassis; None unless it has an inertial sensor of that name,
        and how it stands is described.
        """
        sensor = rig.sensors.get(name)
        if not isinstance(sensor, Imu) or not isinstance(rig, Machine):
            return None
        turn = rig.joints[rig.arm_names.index(rig.turn_joint)]
        height_m = rig.stance.base_height_m + float(turn.T_parent_joint[2, 3])
        return cls(sensor, standing.rate_std_rad_s, height_m)

    def rate_rad_s(self, mean: Float, piece_s: float) -> float:
        """Return how fast the chassis turns [rad/s]; 0 if noise and bias explain it by chance.

        Args:
            mean: Mean rate of a piece of rest, sensor axes [rad/s], shape (3,).
            piece_s: Length of the piece [s].
        """
        off, variance = mean - self._bias, self._variance + self._noise2(piece_s)
        square = float(off @ off)
        is_chance = square <= chance_limit(binary(piece_s)) * variance
        return 0.0 if is_chance else math.sqrt(square - 3 * variance)

    def take(self, stamp_s: float, mean: Float, piece_s: float) -> None:
        """Learn the bias from a piece of rest that ends at a time [s], unless it is known already.

        A piece in which the chassis turns fast tells less of the bias.
        """
        since_s = stamp_s - self._newest_s
        if since_s < piece_s:
            return
        turning2 = self._usual2 + self.rate_rad_s(mean, piece_s) ** 2
        if math.isfinite(since_s):
            self._variance += self._sensor.gyro_walk_rad_s**2 * since_s
        self._newest_s = stamp_s
        gain = self._variance / (self._variance + turning2 + self._noise2(piece_s))
        self._bias = self._bias + gain * (mean - self._bias)
        self._variance *= 1.0 - gain

    def _noise2(self, piece_s: float) -> float:
        """Variance of the mean of a piece along an axis, by the sensor's noise."""
        return self._sensor.gyro_noise_rad_s**2 / (self._sensor.rate_hz * piece_s)
