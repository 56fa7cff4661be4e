"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Radians, Seconds
from executive.interfaces.robot import RobotSettings


class KinematicSettings(RobotSettings):
    """Settings of the robot without physics."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "rng")
    is_simulated: ClassVar[bool] = True

    jaws_stop_at: Radians = Field(
        0.4, ge=0, le=2, description="Angle at which closing jaws stop at a stone [rad]."
    )
    noise: bool = Field(
        False, description="Whether samples have the noise of the machine's sensors."
    )
    fails_at_s: float | None = Field(
        None, ge=0, description="Mission time at which the machine stops responding [s]."
    )
    datum: tuple[float, float, float] = Field(
        (47.4084, 8.5106, 440.0),
        description="Latitude [deg], longitude [deg], altitude [m] of the map's origin.",
    )


class WireSettings(RobotSettings):
    """Settings of a machine behind the robot wire."""

    needs: ClassVar[tuple[str, ...]] = ()

    address: str = Field(description="Where the machine listens: unix:PATH or 127.0.0.1:PORT.")
    answer_limit: Seconds = Field(
        0.5, gt=0, le=10, description="The machine has to answer a command by then [s]."
    )
    silence_limit: Seconds = Field(
        0.5, gt=0, le=10, description="A machine that sends nothing for so long has failed [s]."
    )
    reset_at_start: bool = Field(
        True, description="Reset a stop that an earlier mission ended in, when this one starts."
    )
