"""What a graph begins with, and what it leads to."""

from dataclasses import dataclass, replace

from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import InertialState, retract
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

from executive.arrays import Float

_KNOWN = ClockOffset()


@dataclass(frozen=True, slots=True, eq=False)
class GraphEstimate:
    """A state, and what is known of the receiver's clock.

    Attributes:
        state: The state.
        covariance: Of its error, shape (15, 15).
        clock: The receiver's clock, and what it shares with that error.
        agreeing: How likely the clock agrees with the inertial sensor's; None if it does not.
    """

    state: InertialState
    covariance: Float
    clock: ClockOffset = _KNOWN
    agreeing: AgreeingClock | None = None

    def reported(self) -> tuple[InertialState, Float]:
        """Return state and covariance (15, 15) over both hypotheses, that it agrees or not."""
        clock = self.clock
        if clock.is_known or self.agreeing is None:
            return self.state, self.covariance
        error, P = self.agreeing.mixed(self.covariance, clock.cross, clock.offset_s, clock.std_s)
        return retract(self.state, error), P

    def widened(
        self, noise: InertialNoise, position_m: float, velocity_m_s: float, angle_rad: float
    ) -> "GraphEstimate":
        """Return the same estimate with a covariance that holds further errors as well.

        Args:
            noise: Noise of the inertial sensor.
            position_m: Standard deviation of a further error of position [m].
            velocity_m_s: The same of velocity [m/s].
            angle_rad: The same of attitude [rad].
        """
        wide = ErrorStateFilter(self.state, self.covariance, noise)
        wide.inflate(position_m, velocity_m_s, angle_rad)
        return replace(self, covariance=wide.covariance)
