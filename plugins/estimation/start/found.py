"""What a start hands over: the first state, and what it leaves open."""

from dataclasses import dataclass, field

import numpy as np
from executive_plugins.estimation.inertial.state import DIMENSION, InertialState

from executive.arrays import Float


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


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A state at the newest inertial sample.

    Attributes:
        state: The state.
        covariance: Of its error, shape (15, 15).
        has_heading: Whether the heading is known well enough for a linear filter. If not, the
            covariance holds all headings that explain the fixes.
        clock: The receiver's clock.
        fix_scale: Factor on the fixes' declared variance by which they scatter, at least 1.
    """

    state: InertialState
    covariance: Float
    has_heading: bool
    clock: ClockOffset
    fix_scale: float = 1.0
