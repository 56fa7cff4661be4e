"""An error-state Kalman filter over a strapdown state."""

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import linear_covariance, moved
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.kalman import bias_step
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.kalman.compiled_correction import projected
from executive_plugins.estimation.kalman.judged_fix import USED, use_fix
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_correction import (
    correct,
    report_until,
    write_joint_covariance,
    write_report,
)
from executive_plugins.estimation.kalman.packed_filter import PackedFilter
from executive_plugins.estimation.kalman.packed_measurements import (
    correct_by_compared,
    correct_by_standstill,
)
from executive_plugins.estimation.kalman.packed_prediction import inflate, predict, predict_until
from executive_plugins.estimation.live.layout import ESTIMATE
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float

_NO_CLOCK = ClockOffset()
_predict_until, _report_until = direct(predict_until), direct(report_until)
_use_fix, _correct_by_compared = direct(use_fix), direct(correct_by_compared)
_correct_by_standstill = direct(correct_by_standstill)


class ErrorStateFilter(PackedFilter):
    """A state and the covariance of its error (Solà 2017, Sec. 5–6; error on the right).

    It is predicted by inertial samples and corrected by linearised residuals. Beside the state it
    may estimate companions: quantities that inertial samples do not change. The first is the offset
    of the receiver's clock, unless that is known; subclasses add others.

    Attributes:
        agreeing_clock: How likely the clocks agree; None if they do not.
    """

    def __init__(
        self,
        state: InertialState,
        covariance: Float,
        noise: InertialNoise,
        clock: ClockOffset = _NO_CLOCK,
    ) -> None:
        super().__init__(state, covariance, noise, clock)
        self.agreeing_clock: AgreeingClock | None = None
        self._packed = np.zeros(1, ESTIMATE)

    def predict(self, sample: Inertial) -> None:
        """Propagate to a later sample; a gap in the samples inflates the covariance."""
        if sample.stamp_s > self.stamp_s:
            self._state = None
            predict(self.block, sample.stamp_s, sample.since_last_s, sample.rate, sample.force)

    def predict_until(self, ring: Block, first: int, end: int, until_s: float) -> int:
        """Propagate through samples up to a time; see `packed_prediction.predict_until`."""
        self._state = None
        return int(_predict_until(self.block, ring, first, end, until_s))

    def packed_at(self, ring: Block, first: int, end: int, until_s: float) -> tuple[int, Block]:
        """Do what `predict_until` and `packed` do, in one call."""
        self._state = None
        if self._clocks and self.agreeing_clock is not None:
            return self.predict_until(ring, first, end, until_s), packed(*self.reported())
        first = _report_until(self.block, ring, first, end, until_s, self._packed)
        return first, self._packed

    def reported(self) -> tuple[InertialState, Float]:
        """Return the state that is reported, and its covariance in map axes, shape (15, 15)."""
        if not self._clocks or self.agreeing_clock is None:
            return self.state, self._shown_covariance(self.state, self.covariance)
        error, P = self.agreeing_clock.mixed(
            self.covariance, self._cross[:, 0], self.clock_s, self.clock_std_s
        )
        state, J = moved(self.state, error)
        return state, self._shown_covariance(state, J @ P @ J.T)

    def _shown_covariance(self, state: InertialState, covariance: Float) -> Float:
        """Return a covariance in map axes, with what the fixes err slowly, shape (15, 15)."""
        shown = linear_covariance(state, covariance)
        shown[POSITION, POSITION] += np.diag(self.block["slow_m"][0] ** 2)
        return shown

    def packed(self) -> Block:
        """Return what is reported as a row, shape (1,), dtype `ESTIMATE`; the next replaces it."""
        if self._clocks and self.agreeing_clock is not None:
            return packed(*self.reported())
        write_report(self.block, self._packed)
        return self._packed

    def predicted(self, H: Float, by_clock: Float | None = None) -> Float:
        """Return the covariance of a prediction, shape (m, m); see `correct`."""
        return projected(self._joint(H, by_clock), self._joint_covariance())

    def correct(
        self,
        residual: Float,
        H: Float,
        noise: Float,
        gate: float,
        by_clock: Float | None = None,
    ) -> bool:
        """Correct by measured − predicted = H · error + noise.

        Args:
            residual: Shape (m,).
            H: Shape (m, 15).
            noise: Covariance of the measurement, shape (m, m).
            gate: Largest squared Mahalanobis distance that is accepted.
            by_clock: Derivative by the error of the clock, shape (m,); None if that has no part.

        Returns:
            Whether the measurement was within the gate and was used.
        """
        return self._correct_jointly(residual, self._joint(H, by_clock), noise, gate)

    def use_fix(self, innovations: Block, fix: Fix, late_s: float, holds_clock: bool) -> int:
        """Correct by a fix that is in no doubt, see `judged_fix.use_fix`."""
        position = fix.arm_imu, fix.p_map_antenna, fix.covariance
        said: int = _use_fix(self.block, innovations, *position, late_s, holds_clock)
        if said & USED:
            self._state = None
        return said

    def correct_by_compared(self, gate: float) -> bool:
        """Correct by the fix that was compared last, see `packed_measurements.compare_fix`."""
        return self._told(_correct_by_compared(self.block, gate))

    def correct_by_standstill(
        self, T_imu_cabin: Float, rest: ChassisRest, settings: StandstillSettings, gate: float
    ) -> bool:
        """Correct by a chassis at rest, see `packed_measurements.correct_by_standstill`."""
        known = settings.velocity_std_m_s, settings.rate_std_rad_s, rest.sway_m_s, rest.sway_rad_s
        used = _correct_by_standstill(self.block, T_imu_cabin, rest.rate_cabin, *known, gate)
        return self._told(used)

    def _correct_jointly(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        """Correct state and companions, whose error has 15 + k dimensions."""
        return self._told(correct(self.block, residual, H, noise, gate))

    def forget_object(self) -> None:
        """Forget the object of the state, after compiled code has changed the row."""
        self._state = None

    def _told(self, is_used: bool) -> bool:
        """Return whether a measurement was used, and forget the state before it."""
        if is_used:
            self._state = None
        return is_used

    def _joint(self, H: Float, by_clock: Float | None) -> Float:
        """Return the derivative by the errors of state and companions, shape (m, 15 + k)."""
        joint = np.zeros((len(H), DIMENSION + len(self._own)))
        joint[:, :DIMENSION] = H
        if self._clocks and by_clock is not None:
            joint[:, DIMENSION] = by_clock
        return joint

    def _joint_covariance(self) -> Float:
        """Return the covariance of the errors of state and companions, (15 + k, 15 + k)."""
        joint = np.empty((DIMENSION + len(self._own), DIMENSION + len(self._own)))
        write_joint_covariance(self.block, joint)
        return joint

    def fade(self, factor: float) -> None:
        """Multiply the covariance of the state, less of the biases, by a factor; see `grown`."""
        covariance = self.covariance
        more = bias_step.grown(covariance, factor, *self._usual.step)
        self.covariance = np.outer(more, more) * covariance
        self._cross[:] *= more[:, None]

    def explain(
        self,
        innovation: Float,
        derivatives: tuple[Float, Float | None],
        noise: Float,
        since_s: float,
        share: float = 1.0,
    ) -> None:
        """Add the covariance of a step of the biases that explains an innovation; see `correct`.

        Args:
            innovation: Measured minus predicted, shape (m,).
            derivatives: By the errors of state and clock.
            noise: Covariance of the measurement, shape (m, m).
            since_s: Time since the step [s].
            share: Of the innovation's variance in that of a single one.
        """
        H, S = derivatives[0], share * (self.predicted(*derivatives) + noise)
        C = bias_step.step_covariance(self.state, since_s, *self._usual.step)
        left = bias_step.left(self.covariance, *self._usual.step)
        factor = bias_step.explaining_factor(innovation, S, H @ C @ H.T, left)
        self.covariance = self.covariance + factor * C

    def restore_clock(self, clock_s: float) -> None:
        """Take back an earlier estimate of the clock; what it has moved since may be wrong."""
        if self._clocks:
            self._own[0, 0] += (clock_s - self.clock_s) ** 2
            self.clock_s = clock_s

    def inflate(self, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
        """Add variance to the state: standard deviations of position, velocity and rotation."""
        inflate(self.block, position_m, velocity_m_s, rotation_rad)
