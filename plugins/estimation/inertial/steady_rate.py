"""The angular velocity at a time, averaged for as long as it is steady."""

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import InertialState

from executive.arrays import Float
from executive.geometry import chi_square

# Longest time before and after that is averaged: with 0.003 rad/√s, a noisy gyroscope, an antenna
# 1.5 m off moves by 3 mm/s then.
STEADY_S = 1.0
USUAL_CHANGE = chi_square.quantile(0.95, 3)  # of a rate by noise, squared and in variances


class SteadyRate:
    """Means of the rate about a time, over as many samples as show no change beyond their noise.

    One sample of a gyroscope tells the velocity of an antenna with an error of centimetres a
    second, in another direction at each fix: it looks as if it told the clock of the receiver.

    Source: the choice of a window among nested ones, Lepski 1990.
    """

    def __init__(
        self, samples: SampleBuffer, noise: InertialNoise, about_s: float | None = None
    ) -> None:
        """Sum up the samples.

        Args:
            samples: The inertial samples.
            noise: Noise of the sensor.
            about_s: The only time that will be asked for [s]; None for any.
        """
        near = (-np.inf, np.inf) if about_s is None else (about_s - STEADY_S, about_s + STEADY_S)
        self._stamps_s, rates, _ = samples.arrays(*near)
        self._sums = np.vstack([np.zeros(3), np.cumsum(rates, axis=0)])
        period_s = float(np.median(np.diff(self._stamps_s))) if len(rates) > 1 else 1.0
        self._period_s, self._variance = period_s, noise.gyro_density**2 / period_s
        self._most = max(1, int(STEADY_S / period_s))

    def at(self, stamp_s: float) -> Float:
        """Return the rate with its bias at a time, sensor axes [rad/s], shape (3,).

        Near the oldest or the newest sample it is the mean of what there is on either side.
        """
        near = int(np.searchsorted(self._stamps_s, stamp_s - 0.5 * self._period_s))
        i, half = min(near, len(self._stamps_s) - 1), 1
        most = min(self._most, max(i, len(self._stamps_s) - 1 - i))
        rate, count = self._mean(i, half)
        while 2 * half <= most:
            half *= 2
            wider, more = self._mean(i, half)
            variance = self._variance * (1 / count - 1 / more)
            if np.square(wider - rate).sum() > USUAL_CHANGE * variance:
                break
            rate, count = wider, more
        return rate

    def speed(self, state: InertialState, arm_imu: Float) -> Float:
        """Return the velocity of an antenna by the rate at a state's time [m/s], shape (3,).

        Args:
            state: The state.
            arm_imu: Position of the antenna in IMU axes [m], shape (3,).
        """
        rate = self.at(state.stamp_s) - state.gyro_bias
        return np.asarray(state.v_map_imu + state.R_map_imu @ np.cross(rate, arm_imu))

    def _mean(self, i: int, half: int) -> tuple[Float, int]:
        """Return the mean of as many samples before a place as after it, and their number.

        There are fewer at an end.
        """
        first, last = max(i - half + 1, 0), min(i + half + 1, len(self._stamps_s))
        mean = (self._sums[last] - self._sums[first]) / (last - first)
        return np.asarray(mean), last - first
