"""What a start hands over: the first state, and what it leaves open."""

from dataclasses import dataclass

from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.state import InertialState

from executive.arrays import Float


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
