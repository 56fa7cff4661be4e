"""Settings of the estimation plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import Meters, Seconds, Settings


class GnssGateSettings(Settings):
    """When fixes are used, refused, and used again after an outage."""

    innovation: float = Field(
        22.0, gt=0, description="Largest squared Mahalanobis distance (χ², 3: 1 in 15,000)."
    )
    window_s: Seconds = Field(
        3.0, gt=0, le=30, description="Time over which fixes must agree with the odometry [s]."
    )
    window_drift_m: Meters = Field(
        0.1,
        gt=0,
        le=5,
        description="Largest drift of fixes and odometry apart over the window [m].",
    )
    recover_after: int = Field(
        5,
        ge=1,
        le=1000,
        description="Number of consecutive fixes that must agree before fixes are used again.",
    )
    recover_after_s: Seconds = Field(
        0.8, ge=0, le=60, description="Time over which these fixes must agree [s]."
    )
    recover_drift_m: Meters = Field(
        0.04, gt=0, le=5, description="Largest drift of these fixes against the odometry [m]."
    )
    jump_m: Meters = Field(
        0.3, gt=0, le=10, description="Largest jump between two of these fixes [m]."
    )
    odometry_drift: float = Field(
        0.01,
        ge=0,
        le=0.5,
        description="Drift of odometry as a share of the distance travelled; of the estimate in "
        "fallback as well.",
    )
    odometry_drift_m_s: float = Field(
        0.01, ge=0, le=1, description="Drift of the estimate in fallback per second [m/s]."
    )
    inertial_drift_m_s2: float = Field(
        0.5,
        ge=0,
        le=10,
        description="Error of acceleration in fallback without lidar [m/s²]; default: 3° of tilt.",
    )
    reanchor_after_s: Seconds = Field(
        10.0,
        gt=0,
        le=600,
        description="Fixes that agree for this time are used whatever their position, and odometry "
        "that has failed is used again after it has agreed for as long [s].",
    )
    unlock_after_s: Seconds = Field(
        60.0,
        gt=0,
        le=3600,
        description="Fixes that were refused, or in doubt, for this time are used whatever the "
        "odometry measures [s].",
    )
