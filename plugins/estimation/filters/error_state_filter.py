"""An error-state Kalman filter over a strapdown state: predict by inertial samples, correct by
linearised residuals.
"""

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

_LONG_GAP_S = 0.1  # samples further apart than this say little about what happened between them
_GAP_ACCELERATION_M_S2 = 1.0  # what the machine may do unseen in such a gap
_GAP_RATE_RAD_S = 0.8


class ErrorStateFilter:
    """A state and the covariance of its error, moved on in time (Solà 2017, Sec. 5–6; error on the
    right).
    """

    def __init__(self, state: InertialState, covariance: Float, noise: InertialNoise) -> None:
        self.state = state
        self.covariance = covariance
        self._noise = noise

    def predict(self, sample: Inertial) -> None:
        """Propagate to a later sample; a gap in the samples is paid for with covariance."""
        dt_s = sample.stamp_s - self.state.stamp_s
        if dt_s <= 0:
            return
        self.covariance = self.covariance_after(dt_s)
        if (
            sample.since_last_s > _LONG_GAP_S
        ):  # a share of the gap's doubt, for corrections may fall into it
            share_s = float(np.sqrt(sample.since_last_s * dt_s))
            self.doubt(0.0, _GAP_ACCELERATION_M_S2 * share_s, _GAP_RATE_RAD_S * share_s)
        self.state = propagate(self.state, sample, self._noise.gravity_m_s2)

    def covariance_after(self, dt_s: float) -> Float:
        """Return the covariance a step later, by the state's present rate and force, shape (15,
        15).
        """
        return carry_covariance(self.state, self.covariance, self._noise, dt_s)

    def correct(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        """Correct by measured − predicted = H · error + noise.

        Args:
            residual: Shape (m,).
            H: Shape (m, 15).
            noise: Covariance of the measurement, shape (m, m).
            gate: Largest squared Mahalanobis distance that is believed.

        Returns:
            Whether the measurement passed the gate and was used.
        """
        answer = corrected(self.covariance, H, residual, noise, gate)
        if answer is None:
            return False
        self.covariance, error = answer
        self.state = retract(self.state, error)
        return True

    def doubt(self, position_m: float, velocity_m_s: float, rotation_rad: float) -> None:
        """Forget how well the state is known: add these standard deviations to it."""
        for block, std in (
            (POSITION, position_m),
            (VELOCITY, velocity_m_s),
            (ROTATION, rotation_rad),
        ):
            self.covariance[block, block] += std**2 * np.eye(3)
