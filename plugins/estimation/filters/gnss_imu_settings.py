"""Settings of the inertial-satellite filter."""

from executive_plugins.estimation.cabin.settings import CabinSettings
from pydantic import Field

from executive.config import Seconds


class GnssImuSettings(CabinSettings):
    """Settings of the filter: those of all, and what it believes when."""

    lag_s: Seconds = Field(
        0.1,
        ge=0,
        le=2,
        description="Corrections may come this late [s]; the state is predicted over it.",
    )
    gate: float = Field(
        22.0,
        gt=0,
        description="Largest squared Mahalanobis distance of a fix (χ², 3: 1 in 15,000).",
    )
    reacquire_after: int = Field(
        100, gt=0, description="Fixes refused in a row by the gate until the pose is doubted."
    )
    fallback_after_s: Seconds = Field(
        1.0, gt=0, le=60, description="Time without a used fix until FALLBACK [s]."
    )
