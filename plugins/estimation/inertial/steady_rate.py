"""The angular velocity at a time, averaged for as long as it is steady."""

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer

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

    def __init__(self, samples: SampleBuffer, noise: InertialNoise) -> None:
        """Sum up the samples.

        Args:
            samples: The inertial samples.
            noise: Noise of the sensor.
        """
        self._stamps_s, rates, _ = samples.arrays()
        self._sums = np.vstack([np.zeros(3), np.cumsum(rates, axis=0)])
        period_s = float(np.median(np.diff(self._stamps_s))) if len(rates) > 1 else 1.0
        self._period_s, self._variance = period_s, noise.gyro_density**2 / period_s
        self._most = max(1, int(STEADY_S / period_s))

    def at(self, stamp_s: float) -> Float:
        """Return the rate with its bias at a time, sensor axes [rad/s], shape (3,)."""
        near = int(np.searchsorted(self._stamps_s, stamp_s - 0.5 * self._period_s))
        i, half = min(near, len(self._stamps_s) - 1), 1
        rate = self._mean(i, half)
        while 2 * half <= min(self._most, i, len(self._stamps_s) - 1 - i):
            half *= 2
            wider = self._mean(i, half)
            if np.square(wider - rate).sum() > USUAL_CHANGE * self._variance / (2 * half):
                break
            rate = wider
        return rate

    def _mean(self, i: int, half: int) -> Float:
        """Return the mean of as many samples before a place as after it, fewer at an end."""
        first, last = max(i - half + 1, 0), min(i + half + 1, len(self._stamps_s))
        return np.asarray((self._sums[last] - self._sums[first]) / (last - first))
