"""Settings of the estimation plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from executive_plugins.estimation.cabin.settings import CabinSettings
from pydantic import Field

from executive.config import Seconds


class GnssImuSettings(CabinSettings):
    """Settings of the filter, in addition to those of all cabin estimators."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    lag_s: Seconds = Field(
        0.1,
        ge=0,
        le=2,
        description="Largest delay of measurements [s]; the state is predicted over it.",
    )
    gate: float = Field(
        22.0,
        gt=0,
        description="Largest squared Mahalanobis distance of a fix (χ², 3: 1 in 15,000).",
    )
    reacquire_after_s: Seconds = Field(
        10.0,
        gt=1,
        le=120,
        description="Time of refused fixes after which the estimate begins anew from them [s].",
    )
    fallback_after_s: Seconds = Field(
        1.0, gt=0, le=60, description="Time without a used fix until FALLBACK [s]."
    )


class ErrorStateEkfSettings(GnssImuSettings):
    """Settings of `gnss_imu_filter`, and the accuracy of lidar increments."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    odometry_scale: float = Field(
        1.0, gt=0, le=100, description="Factor on the increments' own standard deviation."
    )
    odometry_drift: float = Field(
        0.01,
        ge=0,
        le=1,
        description="Error of odometry that is the same at each increment, as a share of the way.",
    )
    odometry_gate: float = Field(
        32.0,
        gt=0,
        description="Largest squared Mahalanobis distance of an increment (χ², 6: 1 in 60,000).",
    )
