"""The clock of a receiver against that of the inertial sensor, which stamps the states."""

from dataclasses import dataclass, field

import numpy as np
from executive_plugins.estimation.inertial.state import DIMENSION

from executive.arrays import Float

CLOCK_WALK_S = 1e-4  # of a receiver's clock, in one second: quartzes differ by 100 ppm


@dataclass(frozen=True, slots=True, eq=False)
class ClockOffset:
    """How much the stamps of the receiver are late, as far as it is known.

    Attributes:
        offset_s: Stamp minus time of measurement [s].
        std_s: Its standard deviation [s]; 0 if the clocks are known to agree.
        cross: Covariance of the state's error with the offset's, shape (15,).
    """

    offset_s: float = 0.0
    std_s: float = 0.0
    cross: Float = field(default_factory=lambda: np.zeros(DIMENSION))

    @property
    def is_known(self) -> bool:
        """Whether it need not be estimated."""
        return self.std_s == 0.0
