"""Settings of the estimation plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar, Literal

from executive_plugins.estimation.cabin.settings import CabinSettings
from executive_plugins.estimation.gate.settings import GnssGateSettings
from pydantic import Field

from executive.config import Meters, MetersPerSecond, Radians, RadiansPerSecond, Seconds, Settings


class SmootherSettings(Settings):
    """Settings of the two graphs."""

    lag_s: Seconds = Field(
        3.0,
        ge=0.5,
        le=30,
        description="Length of the window; measurements that are later than this are refused [s].",
    )
    node_after_s: Seconds = Field(
        0.5, gt=0, le=5, description="Longest time between two nodes [s]."
    )
    suspect_after_s: Seconds = Field(
        0.6,
        gt=0,
        le=60,
        description="Time without a used fix until SUSPECT [s]; 1.5 of their usual intervals if "
        "that is longer.",
    )
    fallback_after_s: Seconds = Field(
        1.0,
        gt=0,
        le=60,
        description="Time without a used fix until FALLBACK [s]; 2.5 of their usual intervals if "
        "that is longer.",
    )
    gate: GnssGateSettings = Field(
        default_factory=GnssGateSettings, description="Which fixes are used."
    )
    increment_gate: float = Field(
        32.0,
        gt=0,
        description="Largest squared Mahalanobis distance of an increment of odometry from the "
        "inertial samples (χ², 6: 1 in 60,000).",
    )
    fallback: Literal["relative", "pseudo_global"] = Field(
        "relative",
        description="Source of the estimate without satellites: 'relative' is the main graph with "
        "relative lidar poses, 'pseudo_global' is the paper's second graph.",
    )
    fallback_position_std_m: Meters = Field(
        0.02, gt=0, le=5, description="Standard deviation of a pseudo-global lidar position [m]."
    )
    fallback_yaw_std_rad: Radians = Field(
        0.005, gt=0, le=1, description="Standard deviation of its heading [rad]."
    )
    fallback_level_std_rad: Radians = Field(
        0.05,
        gt=0,
        le=1,
        description="Standard deviation of its roll and pitch [rad]; gravity gives them better.",
    )
    standing_velocity_std_m_s: MetersPerSecond = Field(
        0.01, gt=0, le=1, description="Standard deviation of the speed of a chassis at rest [m/s]."
    )
    standing_rate_std_rad_s: RadiansPerSecond = Field(
        0.005,
        gt=0,
        le=1,
        description="Standard deviation of the angular velocity of a chassis at rest [rad/s].",
    )
    standing_gate: float = Field(
        11.3,
        gt=0,
        description="Largest squared Mahalanobis distance of a chassis at rest (χ², 3: 1 in 100).",
    )
    standing_doubt_s: Seconds = Field(
        1.0,
        ge=0,
        le=30,
        description="Time before and after a contradiction during which standstill is ignored [s].",
    )


class DualGraphSettings(CabinSettings):
    """Settings of the estimator, in addition to those of all cabin estimators."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    process: bool = Field(
        False,
        description="Whether to smooth in a separate process; false gives the same result on each "
        "run.",
    )
    answer_within_s: Seconds = Field(
        1.0,
        gt=0.05,
        le=60,
        description="Time without an answer after which the smoother's process is replaced [s].",
    )
    smoother: SmootherSettings = Field(
        default_factory=SmootherSettings, description="The graphs and the gate."
    )
