"""Settings of calibration: what must be known beforehand, and when a quantity counts as found."""

from executive_plugins.estimation.filters.settings import GnssImuSettings
from pydantic import Field

from executive.config import Meters, Seconds


class KeyframeBatchSettings(GnssImuSettings):
    """Settings of the filter that gives the first guess, and of the batch over keyframes."""

    arm_std_m: Meters = Field(
        0.3, gt=0, le=10, description="Standard deviation of declared lever arms [m]."
    )
    turn_std_rad: float = Field(
        0.1, gt=0, le=0.5, description="Standard deviation of declared mounting angles [rad]."
    )
    unknown_clock_s: Seconds = Field(
        0.15, gt=0, le=1, description="Standard deviation of clocks that nothing synchronises [s]."
    )
    keyframes: int = Field(
        600, ge=100, le=20_000, description="Largest number of keyframes over the recording."
    )
    keyframe_period_s: Seconds = Field(
        0.1,
        gt=0,
        le=10,
        description="Shortest time between two fixes of an antenna that are used [s]: the errors "
        "of a receiver's fixes are not independent over less.",
    )
    clock_bound_s: Seconds = Field(
        0.005, gt=0, le=1, description="95 % bound of a clock's error for it to count as found [s]."
    )
    arm_bound_m: Meters = Field(
        0.03,
        gt=0,
        le=1,
        description="95 % bound of a lever arm's error along an axis for it to count as found [m].",
    )
    turn_bound_rad: float = Field(
        0.01,
        gt=0,
        le=0.5,
        description="95 % bound of a mounting angle's error for it to count as found [rad].",
    )
