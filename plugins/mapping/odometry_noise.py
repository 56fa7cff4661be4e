"""Noise of the state estimate: of a pose, and of the motion between two poses."""

import numpy as np
from executive_plugins.mapping.pose_constraint import PoseConstraint
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Seconds, Settings


class OdometryNoiseSettings(Settings):
    """The estimate's error as a random walk with a correlation time.

    Defaults were measured on the shipped estimators, with satellites of 8 mm and of 40 mm: the
    random walk of their poses is the same.
    """

    rotation_rad: Radians = Field(
        0.002, gt=0, description="Random walk of the attitude in one second [rad]."
    )
    position_m: Meters = Field(
        0.0035, gt=0, description="Random walk of the position in one second [m]."
    )
    correlation_s: Seconds = Field(
        2.0, gt=0, description="Time after which errors are uncorrelated [s]."
    )
    anchor_period_s: Seconds = Field(
        1.0, gt=0, description="Time between two constraints to the estimated pose itself [s]."
    )
    unknown_rotation_rad: Radians = Field(
        0.003, gt=0, description="Rotation error if the estimate gives no covariance [rad]."
    )
    unknown_position_m: Meters = Field(
        0.01, gt=0, description="Position error if the estimate gives no covariance [m]."
    )


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
