"""An error-state filter with a clone of one earlier pose, for relative measurements."""

import numpy as np
from executive_plugins.estimation.filters.compiled_correction import corrected
from executive_plugins.estimation.filters.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    carry_cross,
    retract,
    rotation_step,
)

from executive.arrays import Float
from executive.geometry.rotation import log_so3, skew

_POSE = np.r_[ROTATION, POSITION]
_CLONE = slice(DIMENSION, DIMENSION + 6)
_CLONE_ROTATION, _CLONE_POSITION = (
    slice(DIMENSION, DIMENSION + 3),
    slice(DIMENSION + 3, DIMENSION + 6),
)


class CloningFilter(ErrorStateFilter):
    """Uses relative poses by stochastic cloning (Roumeliotis 2002), as MSF does (Lynen 2013).

    If a relative pose were used as an absolute one, starting from the estimate at its beginning,
    the error of that estimate would count as independent at every step. The clone keeps its
    correlation with the present state.
    """

    _clone_s = -np.inf

    def clone(self) -> None:
        """Clone the present pose; an earlier clone is replaced."""
        self._clone_s = self.state.stamp_s
        self._R, self._p = self.state.R_map_imu, self.state.p_map_imu
        # Covariances of the clone's error with the state's error, (15, 6), and of itself, (6, 6).
        self._cross = self.covariance[:, _POSE].copy()
        self._own = self.covariance[np.ix_(_POSE, _POSE)]

    def has_clone_at(self, stamp_s: float) -> bool:
        """Return whether the clone is of a time [s]."""
        return abs(self._clone_s - stamp_s) < 1e-6

    def predict(self, sample: Inertial) -> None:
        if np.isfinite(self._clone_s) and sample.stamp_s > self.state.stamp_s:
            self._cross = carry_cross(self.state, self._cross, sample.stamp_s - self.state.stamp_s)
        super().predict(sample)

    def correct(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        if not np.isfinite(self._clone_s):
            return super().correct(residual, H, noise, gate)
        return self._correct_both(residual, np.hstack([H, np.zeros((len(H), 6))]), noise, gate)

    def correct_by_increment(self, T_from_to: Float, covariance: Float, gate: float) -> bool:
        """Correct by the measured motion of the IMU since the clone.

        Args:
            T_from_to: The IMU now in the IMU at the clone, shape (4, 4).
            covariance: As (rotation, translation) in the later frame, shape (6, 6).
            gate: Largest squared Mahalanobis distance that is accepted.

        Returns:
            Whether the measurement was within the gate and was used.
        """
        residual, H, R_from_to = self._increment_residual(T_from_to)
        J = np.eye(6)
        J[3:, 3:] = R_from_to
        noise = J @ covariance @ J.T
        return self._correct_both(residual, H, noise, gate)

    def _correct_both(self, residual: Float, H: Float, noise: Float, gate: float) -> bool:
        """Correct the state and the clone by their joint error of 21 dimensions."""
        joint = np.empty((DIMENSION + 6, DIMENSION + 6))
        joint[:DIMENSION, :DIMENSION], joint[_CLONE, _CLONE] = self.covariance, self._own
        joint[:DIMENSION, _CLONE], joint[_CLONE, :DIMENSION] = self._cross, self._cross.T
        answer = corrected(joint, H, residual, noise, gate)
        if answer is None:
            return False
        P, error = answer
        self.covariance, self._own = P[:DIMENSION, :DIMENSION], P[_CLONE, _CLONE]
        self._cross = P[:DIMENSION, _CLONE]
        self.state = retract(self.state, error[:DIMENSION])
        self._R, self._p = (
            self._R @ rotation_step(error[_CLONE_ROTATION]),
            self._p + error[_CLONE_POSITION],
        )
        return True

    def _increment_residual(self, T_from_to: Float) -> tuple[Float, Float, Float]:
        """Return measured − predicted (6,), its derivative by both errors (6, 21), and a rotation.

        With R = R̂ exp(θ) at both ends, the motion's error is θ − Rᵀθ_c in rotation and, in the
        earlier frame, R_cᵀ(δp − δp_c) + [p]× θ_c in translation. The rotation R is the predicted
        one.
        """
        R = self._R.T @ self.state.R_map_imu
        p = self._R.T @ (self.state.p_map_imu - self._p)
        H = np.zeros((6, DIMENSION + 6))
        H[:3, ROTATION], H[:3, _CLONE_ROTATION] = np.eye(3), -R.T
        H[3:, POSITION], H[3:, _CLONE_POSITION], H[3:, _CLONE_ROTATION] = (
            self._R.T,
            -self._R.T,
            skew(p),
        )
        return np.concatenate([log_so3(R.T @ T_from_to[:3, :3]), T_from_to[:3, 3] - p]), H, R
