"""Position and velocity while the heading is not known yet."""

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import POSITION, VELOCITY, Inertial
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.wide_heading import moments

from executive.arrays import Float

_LAG_S = 0.1  # at first; the filter trails by more once a fix comes later


class _ConsideringFilter(ErrorStateFilter):
    """Corrects position and velocity; attitude, biases and clock are considered, not estimated.

    Their errors are too large for a linear correction, which would make them certain and wrong.
    Source: the Schmidt-Kalman filter (Schmidt 1966).
    """

    def correct(
        self, residual: Float, H: Float, noise: Float, gate: float, by_clock: Float | None = None
    ) -> bool:
        H, P = self._joint(H, by_clock), self._joint_covariance()
        S = H @ P @ H.T + noise
        if not residual @ np.linalg.solve(S, residual) <= gate:
            return False
        K = np.linalg.solve(S, H @ P).T
        K[: VELOCITY.start] = K[POSITION.stop :] = 0.0
        J = np.eye(len(P)) - K @ H
        self._take(J @ P @ J.T + K @ noise @ K.T, K @ residual)
        return True

    def reported_covariance(self) -> Float:
        return moments(self.state, self.covariance)


class Aligning:
    """The state of a body whose heading is not known, from one attempt to find it to the next."""

    def __init__(
        self, found: Found, noise: InertialNoise, propagator: LivePropagator, gate: float
    ) -> None:
        """Begin at a state, and set the propagator to it.

        Args:
            found: The state.
            noise: Noise of the inertial sensor.
            propagator: Reports the state at the newest sample.
            gate: Largest squared Mahalanobis distance of a fix.
        """
        self._late_s, self._scale, self._gate = found.clock.offset_s, found.fix_scale, gate
        kalman = _ConsideringFilter(found.state, found.covariance, noise, found.clock)
        self._trailing = TrailingFilter(kalman, _LAG_S, propagator)

    def add_sample(self, sample: Inertial) -> None:
        """Add an inertial sample that the propagator has taken."""
        self._trailing.add_sample(sample)

    def add_fix(self, fix: Fix) -> None:
        """Correct by a fix."""
        kalman, late_s = self._trailing.kalman, self._late_s

        def apply() -> None:
            residual, H, by_clock, noise = fix_residual(kalman, fix, late_s)
            kalman.correct(residual, H, self._scale * noise, self._gate, by_clock)

        self._trailing.add(Correction(fix.stamp_s - late_s, apply))
