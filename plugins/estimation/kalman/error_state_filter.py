"""An error-state Kalman filter over a strapdown state."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.inertial.clock_offset import CLOCK_WALK_S, ClockOffset
from executive_plugins.estimation.inertial.exponential import linear_covariance, moved
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    carry_covariance,
    stepped,
)
from executive_plugins.estimation.inertial.usual_motion import UsualMotion
from executive_plugins.estimation.kalman import bias_step
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.kalman.compiled_correction import considered, corrected, projected

from executive.arrays import Float

_LONG_GAP_S = 0.1  # over a longer gap, the samples do not describe the motion
_NO_CLOCK = ClockOffset()


class ErrorStateFilter:
    """A state and the covariance of its error (Solà 2017, Sec. 5–6; error on the right).

    It is predicted by inertial samples and corrected by linearised residuals. Beside the state it
    may estimate companions: quantities that inertial samples do not change. The first is the offset
    of the receiver's clock, unless that is known; subclasses add others.

    Attributes:
        state: The state.
        covariance: Of its error, shape (15, 15).
        clock_s: Stamps of the fixes minus times of measurement [s].
        holds_clock: Whether corrections leave the clock as it is, and only consider its error.
        agreeing_clock: How likely the clocks agree; None if they do not.
        gap_s: Time of the newest gap in the samples that was bridged [s]; -inf if there was none.
    """

    def __init__(
        self,
        state: InertialState,
        covariance: Float,
        noise: InertialNoise,
        clock: ClockOffset = _NO_CLOCK,
    ) -> None:
        self.state = state
        self.covariance = covariance
        self.clock_s = clock.offset_s
        self.holds_clock = False
        self.agreeing_clock: AgreeingClock | None = None
        self._noise = noise
        self.gap_s = -np.inf
        self._usual = UsualMotion()
        self._mean_rate = state.sample.rate  # over the time by which the clock is unknown
        self._clocks = int(clock.std_s > 0)  # number of companions that are clocks
        # Covariances of the state's error with the companions', (15, k), and of these, (k, k).
        self._cross = clock.cross[:, None][:, : self._clocks].copy()
        self._own = np.full((self._clocks, self._clocks), clock.std_s**2)

    @property
    def clock_std_s(self) -> float:
        """Standard deviation of the clock's offset [s]; 0 if it is known."""
        return float(np.sqrt(self._own[0, 0])) if self._clocks else 0.0

    def predict(self, sample: Inertial) -> None:
        """Propagate to a later sample; a gap in the samples inflates the covariance."""
        dt_s = sample.stamp_s - self.state.stamp_s
        if dt_s <= 0:
            return
        if self._clocks:
            self._own[0, 0] += dt_s * CLOCK_WALK_S**2
            weight = dt_s / (dt_s + self.clock_std_s)
            self._mean_rate = self._mean_rate + weight * (sample.rate - self._mean_rate)
        since_last_s, is_gap = sample.since_last_s, sample.since_last_s > _LONG_GAP_S
        if is_gap:
            sample = self._at_constant_velocity(sample)
        elif self._usual.is_due(sample.stamp_s):
            self._usual.add(sample.stamp_s, self.acceleration(), self.state.rate)
        self.state, self.covariance, self._cross = stepped(
            self.state, self.covariance, self._cross, sample, self._noise
        )
        if is_gap:
            self.gap_s = sample.stamp_s
            self._inflate_by_gap(since_last_s, dt_s)

    def _inflate_by_gap(self, since_last_s: float, dt_s: float) -> None:
        """Add a share of a gap's variance, since the gap may be integrated in several parts."""
        share_s = float(np.sqrt(since_last_s * dt_s))
        velocity_m_s = self._usual.acceleration_m_s2 * share_s
        rotation_rad = self._usual.rate_rad_s * share_s
        self.inflate(0.5 * since_last_s * velocity_m_s, velocity_m_s, rotation_rad)

    def _at_constant_velocity(self, sample: Inertial) -> Inertial:
        """Return a sample of unaccelerated motion: one after a gap does not tell of the gap."""
        state = self.state
        weight = state.R_map_imu.T @ [0.0, 0.0, self._noise.gravity_m_s2]
        return replace(sample, rate=state.gyro_bias, force=state.accel_bias + weight)

    def acceleration(self) -> Float:
        """Return the acceleration at the newest sample, map axes [m/s²], shape (3,)."""
        force = self.state.sample.force - self.state.accel_bias
        return self.state.R_map_imu @ force - [0.0, 0.0, self._noise.gravity_m_s2]

    def reported(self) -> tuple[InertialState, Float]:
        """Return the state that is reported, and its covariance in map axes, shape (15, 15)."""
        if not self._clocks or self.agreeing_clock is None:
            return self.state, linear_covariance(self.state, self.covariance)
        error, P = self.agreeing_clock.mixed(
            self.covariance, self._cross[:, 0], self.clock_s, self.clock_std_s
        )
        state, J = moved(self.state, error)
        return state, linear_covariance(state, J @ P @ J.T)

    def covariance_after(self, dt_s: float) -> Float:
        """Return the covariance after a step at the present rate and force, shape (15, 15)."""
        return carry_covariance(self.state, self.covariance, self._noise, dt_s)

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

    def _joint(self, H: Float, by_clock: Float | None) -> Float:
        """Return the derivative by the errors of state and companions, shape (m, 15 + k)."""
        if not self._own.size:
            return H
        joint = np.zeros((len(H), DIMENSION + len(self._own)))
        joint[:, :DIMENSION] = H
        if self._clocks and by_clock is not None:
            joint[:, DIMENSION] = by_clock
        return joint

    def _joint_covariance(self) -> Float:
        """Return the covariance of the errors of state and companions, (15 + k, 15 + k)."""
        if not self._own.size:
            return self.covariance
        joint = np.empty((DIMENSION + len(self._own), DIMENSION + len(self._own)))
        joint[:DIMENSION, :DIMENSION] = self.covariance
        joint[:DIMENSION, DIMENSION:], joint[DIMENSION:, :DIMENSION] = self._cross, self._cross.T
        joint[DIMENSION:, DIMENSION:] = self._own
        return joint

    def _correct_jointly(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        """Correct the state and its companions, whose error has 15 + k dimensions."""
        before = self._joint_covariance()
        answer = corrected(before, H, residual, noise, gate)
        if answer is None:
            return False
        P, error = answer
        if self._clocks and self.holds_clock:
            P, error = considered(before, H, residual, noise, DIMENSION)
        self._take(P, error)
        return True

    def _take(self, P: Float, error: Float) -> None:
        """Apply a correction with the covariance after it, of 15 + k dimensions."""
        before, J = self.state, np.eye(len(P))
        self.state, J[:DIMENSION, :DIMENSION] = self._moved(error[:DIMENSION])
        if self._own.size:
            J[DIMENSION:, DIMENSION:] = self._move_companions(error[DIMENSION:])
        P = projected(J, P)
        if self._own.size:
            self._cross, self._own = P[:DIMENSION, DIMENSION:], P[DIMENSION:, DIMENSION:]
        self.covariance = P[:DIMENSION, :DIMENSION]
        if self._clocks:
            self._follow_shift(before, J[:DIMENSION, :DIMENSION])

    def _moved(self, error: Float) -> tuple[InertialState, Float]:
        """Return the state after a correction, and the derivative of its error by the error."""
        return moved(self.state, error)

    def _follow_shift(self, before: InertialState, J: Float) -> None:
        """Keep the state at the receiver's time where it was when a correction changes the motion.

        A clock that is late by more, with a state that is later by as much, explains every fix as
        well as before unless the motion changes. The correlations of the clock's error hold the
        motion of the state before the correction. Left so, each correction of the velocity, mere
        noise, would tell of the clock, as with any direction that linearisations at differing
        estimates make observable (Huang 2010, observability-based rules).
        """
        change = self._shift(self.state) - J @ self._shift(before)
        with_clock = np.outer(change, self._cross[:, 0])
        self.covariance = (
            self.covariance + with_clock + with_clock.T + self._own[0, 0] * np.outer(change, change)
        )
        self._cross = self._cross + np.outer(change, self._own[0])

    def _shift(self, state: InertialState) -> Float:
        """Return the change of a state over time, as an error per second, shape (15,)."""
        answer = np.zeros(DIMENSION)
        force = state.R_map_imu @ (state.sample.force - state.accel_bias)
        answer[ROTATION] = state.rate
        answer[VELOCITY] = force - [0.0, 0.0, self._noise.gravity_m_s2]
        answer[POSITION] = self._shown(state.v_map_imu)
        return answer

    def _shown(self, velocity: Float) -> Float:
        """Return a velocity without what may be its own error, shape (3,) [m/s].

        The error of a body at rest would tell of the clock at each fix. Source: the estimate of
        James and Stein 1961, which shrinks towards zero.
        """
        variance = float(np.trace(self.covariance[VELOCITY, VELOCITY]))
        return max(0.0, 1.0 - variance / max(float(velocity @ velocity), 1e-12)) * velocity

    def antenna_shift(self, arm_imu: Float) -> Float:
        """Return the derivative of an antenna's position by time, as far as it is known [m/s].

        Args:
            arm_imu: The antenna in IMU axes [m], shape (3,).
        """
        rate = self._mean_rate - self.state.gyro_bias
        return self._shown(self.state.v_map_imu) + self.state.R_map_imu @ np.cross(rate, arm_imu)

    def _move_companions(self, error: Float) -> Float:
        """Apply a correction to the companions, shape (k,).

        Returns:
            The derivative of what is left of their error by it, shape (k, k).
        """
        if self._clocks:
            self.clock_s += float(error[0])
        return np.eye(len(error))

    def fade(self, factor: float) -> None:
        """Multiply the covariance of the state, less of the biases, by a factor; see `grown`."""
        more = bias_step.grown(self.covariance, factor, *self._usual.step)
        self.covariance = np.outer(more, more) * self.covariance
        self._cross = more[:, None] * self._cross

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
            own = self._own.copy()
            own[0, 0] += (clock_s - self.clock_s) ** 2
            self.clock_s, self._own = clock_s, own

    def inflate(self, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
        """Add variance to the state: standard deviations of position, velocity and rotation."""
        self.covariance = self.covariance.copy()  # it may have been given out
        for block, std in (
            (POSITION, position_m),
            (VELOCITY, velocity_m_s),
            (ROTATION, rotation_rad),
        ):
            self.covariance[block, block] += std**2 * np.eye(3)
