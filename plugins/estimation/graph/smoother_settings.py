"""Settings of the two graphs."""

from typing import Literal

from executive_plugins.estimation.gate.gnss_gate import GnssGateSettings
from pydantic import Field

from executive.config import Meters, MetersPerSecond, Radians, RadiansPerSecond, Seconds, Settings


class SmootherSettings(Settings):
    """Settings of the two graphs."""

    lag_s: Seconds = Field(
        3.0, ge=0.5, le=30, description="Time that is smoothed; later measurements are refused [s]."
    )
    node_after_s: Seconds = Field(
        0.5, gt=0, le=5, description="A node is made after so long without one [s]."
    )
    suspect_after_s: Seconds = Field(
        0.6, gt=0, le=60, description="Time without a used fix until SUSPECT [s]."
    )
    fallback_after_s: Seconds = Field(
        1.0, gt=0, le=60, description="Time without a used fix until FALLBACK [s]."
    )
    gate: GnssGateSettings = Field(
        default_factory=GnssGateSettings, description="Which fixes are believed."
    )
    fallback: Literal["relative", "pseudo_global"] = Field(
        "relative",
        description="What leads without satellites: the main graph by relative poses, or the "
        "paper's second one.",
    )
    fallback_position_std_m: Meters = Field(
        0.02, gt=0, le=5, description="Standard deviation of a pseudo-global lidar position [m]."
    )
    fallback_yaw_std_rad: Radians = Field(0.005, gt=0, le=1, description="Of its heading [rad].")
    fallback_level_std_rad: Radians = Field(
        0.05,
        gt=0,
        le=1,
        description="Of its roll and pitch [rad]; large, for gravity tells them better.",
    )
    standing_velocity_std_m_s: MetersPerSecond = Field(
        0.01, gt=0, le=1, description="Speed that a standing chassis may have [m/s]."
    )
    standing_rate_std_rad_s: RadiansPerSecond = Field(
        0.005, gt=0, le=1, description="Turn that it may have [rad/s]."
    )
    standing_gate: float = Field(
        11.3,
        gt=0,
        description="Largest squared Mahalanobis distance of a standing chassis (χ², 3: 1 in 100).",
    )
    standing_doubt_s: Seconds = Field(
        1.0,
        ge=0,
        le=30,
        description="Time around one that is farther off in which it is not believed [s].",
    )
