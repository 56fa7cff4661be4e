"""An error-state Kalman filter over a strapdown state."""

import numpy as np
from executive_plugins.estimation.filters.compiled_correction import corrected
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    carry_covariance,
    propagate,
    retract,
)

from executive.arrays import Float

_LONG_GAP_S = 0.1  # over a longer gap, the samples do not describe the motion
_GAP_ACCELERATION_M_S2 = 1.0  # possible motion of the machine during such a gap
_GAP_RATE_RAD_S = 0.8


class ErrorStateFilter:
    """A state and the covariance of its error (Solà 2017, Sec. 5–6; error on the right).

    It is predicted by inertial samples and corrected by linearised residuals.
    """

    def __init__(self, state: InertialState, covariance: Float, noise: InertialNoise) -> None:
        self.state = state
        self.covariance = covariance
        self._noise = noise

    def predict(self, sample: Inertial) -> None:
        """Propagate to a later sample; a gap in the samples inflates the covariance."""
        dt_s = sample.stamp_s - self.state.stamp_s
        if dt_s <= 0:
            return
        self.covariance = self.covariance_after(dt_s)
        if sample.since_last_s > _LONG_GAP_S:
            # Only a share of the gap's variance: the gap may be integrated in several parts.
            share_s = float(np.sqrt(sample.since_last_s * dt_s))
            self.inflate(0.0, _GAP_ACCELERATION_M_S2 * share_s, _GAP_RATE_RAD_S * share_s)
        self.state = propagate(self.state, sample, self._noise.gravity_m_s2)

    def covariance_after(self, dt_s: float) -> Float:
        """Return the covariance after a step at the present rate and force, shape (15, 15)."""
        return carry_covariance(self.state, self.covariance, self._noise, dt_s)

    def correct(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        """Correct by measured − predicted = H · error + noise.

        Args:
            residual: Shape (m,).
            H: Shape (m, 15).
            noise: Covariance of the measurement, shape (m, m).
            gate: Largest squared Mahalanobis distance that is accepted.

        Returns:
            Whether the measurement was within the gate and was used.
        """
        answer = corrected(self.covariance, H, residual, noise, gate)
        if answer is None:
            return False
        self.covariance, error = answer
        self.state = retract(self.state, error)
        return True

    def inflate(self, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
        """Add variance to the state: standard deviations of position, velocity and rotation."""
        for block, std in (
            (POSITION, position_m),
            (VELOCITY, velocity_m_s),
            (ROTATION, rotation_rad),
        ):
            self.covariance[block, block] += std**2 * np.eye(3)
