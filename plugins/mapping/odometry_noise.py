"""Noise of the state estimate: of a pose, and of the motion between two poses."""

import numpy as np
from executive_plugins.mapping.pose_constraint import PoseConstraint
from executive_plugins.mapping.settings import OdometryNoiseSettings

from executive.arrays import Float


class OdometryNoise:
    """Makes constraints from the estimate's covariance."""

    def __init__(self, settings: OdometryNoiseSettings) -> None:
        self._settings = settings
        self._wander = np.repeat([settings.rotation_rad**2, settings.position_m**2], 3)
        self._unknown = np.diag(
            np.repeat([settings.unknown_rotation_rad**2, settings.unknown_position_m**2], 3)
        )

    def increment(
        self,
        T_before_this: Float,
        duration_s: float,
        covariance: Float | None,
        before: Float | None,
    ) -> PoseConstraint:
        """Return the motion between two estimated poses as a constraint.

        Its variance grows with time, up to the sum of both poses' variances. A change of the
        estimate's covariance is added: if it has shrunk, the estimate was corrected by about as
        much; if it has grown, the estimate had no measurements.
        """
        now, then = np.diag(self._of(covariance)), np.diag(self._of(before))
        wander = np.minimum(self._wander * max(duration_s, 1e-3), now + then)
        return PoseConstraint(T_before_this, np.diag(wander + np.abs(now - then)))

    def anchor(
        self, T_map_cabin: Float, since_last_s: float, covariance: Float | None
    ) -> PoseConstraint:
        """Return a pose as a constraint.

        Its variance is scaled up while its error is still correlated with that of the last anchor.
        """
        repeated = max(1.0, 2.0 * self._settings.correlation_s / max(since_last_s, 1e-3))
        return PoseConstraint(T_map_cabin, repeated * self._of(covariance))

    def is_due(self, since_last_s: float) -> bool:
        """Return whether it is time for an anchor."""
        return since_last_s >= self._settings.anchor_period_s

    def _of(self, covariance: Float | None) -> Float:
        return self._unknown if covariance is None else covariance + 1e-12 * np.eye(6)
