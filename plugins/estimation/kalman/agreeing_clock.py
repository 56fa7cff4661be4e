"""What a filter reports while the receiver's clock may as well agree with the inertial sensor's.

Most receivers are synchronised, and some are not: a clock that agrees is one hypothesis, and one
that is off by an unknown time is another (spike and slab, Mitchell and Beauchamp 1988). The filter
estimates the clock under the second. As the first is its special case, the ratio of their
likelihoods is that of the densities of an offset of zero after and before the measurements
(Dickey 1971), and no second filter is needed.
"""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float


@dataclass(frozen=True, slots=True)
class AgreeingClock:
    """What is known of a clock before anything is measured.

    Attributes:
        probability: Probability that the clocks agree, at least 0 and less than 1.
        std_s: Standard deviation of the offset if they do not [s]; more than 0.
    """

    probability: float
    std_s: float

    def probability_after(self, offset_s: float, std_s: float) -> float:
        """Return the probability that the clocks agree after measurements.

        Args:
            offset_s: Offset that was estimated for a clock that is off [s].
            std_s: Its standard deviation [s]; more than 0.
        """
        ratio = self.std_s / std_s * np.exp(-0.5 * (offset_s / std_s) ** 2)
        odds = self.probability / (1.0 - self.probability) * float(ratio)
        return odds / (1.0 + odds)

    def mixed(
        self, covariance: Float, cross: Float, offset_s: float, std_s: float
    ) -> tuple[Float, Float]:
        """Return mean and covariance of a state's error over both hypotheses.

        Args:
            covariance: Of the error if the clock is off, shape (n, n); the mean is zero then.
            cross: Covariance of the error with the clock's, shape (n,).
            offset_s: Offset that was estimated [s].
            std_s: Its standard deviation [s]; more than 0.

        Returns:
            The mean, shape (n,), and the covariance, shape (n, n).
        """
        share, by_clock = self.probability_after(offset_s, std_s), cross / std_s**2
        spread = share * (1.0 - share) * offset_s**2 - share * std_s**2
        return -share * offset_s * by_clock, covariance + spread * np.outer(by_clock, by_clock)
