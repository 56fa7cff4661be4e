"""How surely the state estimate knows a pose, and a motion between two poses."""

import numpy as np
from executive_plugins.mapping.pose_constraint import PoseConstraint
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Seconds, Settings


class OdometryNoiseSettings(Settings):
    """The estimate's error as a process that wanders, and forgets where it was.

    Defaults were measured on the shipped estimators, with satellites of 8 mm and of 40 mm: their
    poses wander alike.
    """

    rotation_rad: Radians = Field(
        0.002, gt=0, description="Wander of the attitude in one second [rad]."
    )
    position_m: Meters = Field(
        0.0035, gt=0, description="Wander of the position in one second [m]."
    )
    correlation_s: Seconds = Field(
        2.0, gt=0, description="Time after which an error is a new one [s]."
    )
    anchor_period_s: Seconds = Field(
        1.0, gt=0, description="Time between ties to the estimate itself [s]."
    )
    unknown_rotation_rad: Radians = Field(
        0.003, gt=0, description="Error where the estimate tells none [rad]."
    )
    unknown_position_m: Meters = Field(
        0.01, gt=0, description="Error where the estimate tells none [m]."
    )


class OdometryNoise:
    """Turns the estimate's covariance into constraints."""

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
        """Return a motion between two estimated poses with covariances of their own.

        It wanders with time, but no farther than two errors lie apart. Where the covariance has
        shrunk, the estimate was corrected by about as much, and where it has grown, it went blind
        for that long.
        """
        now, then = np.diag(self._of(covariance)), np.diag(self._of(before))
        wander = np.minimum(self._wander * max(duration_s, 1e-3), now + then)
        return PoseConstraint(T_before_this, np.diag(wander + np.abs(now - then)))

    def anchor(
        self, T_map_cabin: Float, since_last_s: float, covariance: Float | None
    ) -> PoseConstraint:
        """Return a pose; errors that are still the same ones as at the last anchor count less."""
        repeated = max(1.0, 2.0 * self._settings.correlation_s / max(since_last_s, 1e-3))
        return PoseConstraint(T_map_cabin, repeated * self._of(covariance))

    def is_due(self, since_last_s: float) -> bool:
        """Say whether it is time for an anchor."""
        return since_last_s >= self._settings.anchor_period_s

    def _of(self, covariance: Float | None) -> Float:
        return self._unknown if covariance is None else covariance + 1e-12 * np.eye(6)
