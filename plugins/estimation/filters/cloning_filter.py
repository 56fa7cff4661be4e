"""An error-state filter with a clone of one earlier pose, for relative measurements."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

from executive.arrays import Float
from executive.geometry.rotation import log_so3, skew

_POSE = np.r_[ROTATION, POSITION]


@dataclass(frozen=True, slots=True, eq=False)
class IncrementInnovation:
    """A measured motion beside the predicted one, as rotation [rad] and translation [m].

    Attributes:
        residual: Measured minus predicted, shape (6,).
        H: Its derivative by the errors of state and companions, shape (6, 15 + k).
        noise: Covariance of the measurement, shape (6, 6).
        predicted: Covariance of the prediction, shape (6, 6).
    """

    residual: Float
    H: Float
    noise: Float
    predicted: Float


class CloningFilter(ErrorStateFilter):
    """Uses relative poses by stochastic cloning (Roumeliotis 2002), as MSF does (Lynen 2013).

    If a relative pose were used as an absolute one, starting from the estimate at its beginning,
    the error of that estimate would count as independent at every step. The clone is a companion of
    the state and keeps its correlation with it.
    """

    _clone_s = -np.inf

    @property
    def _R(self) -> Float:
        """A copy of the clone's orientation, shape (3, 3)."""
        return np.array(self.block["clone_R"][0])

    @property
    def _p(self) -> Float:
        """A copy of the clone's position in the map [m], shape (3,)."""
        return np.array(self.block["clone_p"][0])

    def clone(self) -> None:
        """Clone the present pose; an earlier clone is replaced."""
        row, k = self.block[0], self._clocks
        P, clocks = row["P"], row["cross"][:, :k]
        self._clone_s = self.stamp_s
        row["clone_R"], row["clone_p"], row["companions"] = row["R"], row["p"], k + len(_POSE)
        own = self._own
        own[k:, k:] = P[np.ix_(_POSE, _POSE)]
        own[:k, k:], own[k:, :k] = clocks[_POSE].T, clocks[_POSE]
        self._cross[:, k:] = P[:, _POSE]

    def become(self, other: "CloningFilter") -> None:
        """Take state, covariance and clone of another filter."""
        self.block[:] = other.block
        self._state, self._clone_s = None, other._clone_s

    def drop_clone(self) -> None:
        """Forget the clone: a filter without one is faster to predict."""
        self.block["companions"], self._clone_s = self._clocks, -np.inf

    def has_clone_at(self, stamp_s: float) -> bool:
        """Return whether the clone is of a time [s]."""
        return abs(self._clone_s - stamp_s) < 1e-6

    def increment(self, T_from_to: Float, covariance: Float) -> IncrementInnovation:
        """Compare the measured motion of the IMU since the clone with the predicted one.

        Args:
            T_from_to: The IMU now in the IMU at the clone, shape (4, 4).
            covariance: As (rotation, translation) in the later frame, shape (6, 6).
        """
        residual, H, R_from_to = self._increment_residual(T_from_to)
        J = np.eye(6)
        J[3:, 3:] = R_from_to
        predicted = H @ self._joint_covariance() @ H.T
        return IncrementInnovation(residual, H, J @ covariance @ J.T, predicted)

    def correct_by_increment(self, innovation: IncrementInnovation, gate: float) -> bool:
        """Correct by a motion; return whether it was within a gate and was used."""
        return self._correct_jointly(innovation.residual, innovation.H, innovation.noise, gate)

    def _increment_residual(self, T_from_to: Float) -> tuple[Float, Float, Float]:
        """Return measured − predicted (6,), its derivative by all errors, and a rotation.

        With R = R̂ exp(θ) at both ends, the motion's error is θ − Rᵀθ_c in rotation and, in the
        earlier frame, R_cᵀ(δp − δp_c) + [p]× θ_c in translation. The rotation R is the predicted
        one.
        """
        R = self._R.T @ self.state.R_map_imu
        p = self._R.T @ (self.state.p_map_imu - self._p)
        first = DIMENSION + self._clocks
        turn, shift = slice(first, first + 3), slice(first + 3, first + 6)  # of the clone
        H = np.zeros((6, first + 6))
        H[:3, ROTATION], H[:3, turn] = np.eye(3), -R.T
        H[3:, POSITION], H[3:, shift], H[3:, turn] = (
            self._R.T,
            -self._R.T,
            skew(p),
        )
        return np.concatenate([log_so3(R.T @ T_from_to[:3, :3]), T_from_to[:3, 3] - p]), H, R
