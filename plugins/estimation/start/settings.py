"""Settings of the estimation plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import RadiansPerSecond, Seconds, Settings


class RestSettings(Settings):
    """Conditions under which the machine counts as being at rest."""

    duration_s: Seconds = Field(
        2.0, gt=0, le=60, description="Time at rest that is needed before the first state [s]."
    )
    max_rate_rad_s: RadiansPerSecond = Field(
        0.02, gt=0, le=0.2, description="Largest mean angular velocity that may be a bias [rad/s]."
    )
    max_rate_std_rad_s: RadiansPerSecond = Field(
        0.02, gt=0, le=0.2, description="Largest spread of the angular velocity [rad/s]."
    )
    max_force_std_m_s2: float = Field(
        0.3, gt=0, le=5, description="Largest spread of the specific force [m/s²]."
    )
    max_antenna_std_m: float = Field(
        0.06,
        gt=0,
        le=1,
        description="Largest spread of an antenna's fixes [m]; larger where the fixes state so.",
    )


class StandstillSettings(Settings):
    """When the chassis counts as being at rest, and how accurate that information is.

    A chassis without an inertial sensor never counts as being at rest.
    """

    is_used: bool = Field(
        True, description="Whether to correct the estimate while the chassis is at rest."
    )
    max_rate_std_rad_s: RadiansPerSecond = Field(
        0.01,
        gt=0,
        le=0.2,
        description="Largest standard deviation of the chassis' angular velocity [rad/s].",
    )
    max_force_std_m_s2: float = Field(
        0.1,
        gt=0,
        le=5,
        description="Largest standard deviation of the chassis' specific force [m/s²].",
    )
    velocity_std_m_s: float = Field(
        0.01, gt=0, le=1, description="Standard deviation of the speed of a chassis at rest [m/s]."
    )
    rate_std_rad_s: RadiansPerSecond = Field(
        0.005,
        gt=0,
        le=1,
        description="Standard deviation of the angular velocity of a chassis at rest [rad/s].",
    )


class WindowStartSettings(Settings):
    """The start of a body that moves, and of one whose heading shows in motion only."""

    window_s: Seconds = Field(
        40.0,
        gt=1,
        le=120,
        description="Longest window of samples and fixes that is solved for a first state [s]; "
        "what is older is forgotten.",
    )
    doubt_window_s: Seconds = Field(
        20.0,
        gt=1,
        le=120,
        description="The same of fixes that contradict a state [s]; after a fault, it holds wrong "
        "samples for as long.",
    )
    max_heading_std_rad: float = Field(
        0.15,
        gt=0,
        le=1,
        description="Standard deviation of the heading from which an estimate begins [rad]; at "
        "0.15 the filters' linear models err by 1 %.",
    )

    def of_doubt(self) -> "WindowStartSettings":
        """Return the settings with the window of a doubt."""
        return self.model_copy(update={"window_s": self.doubt_window_s})
