"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Radians
from executive.interfaces.robot import RobotSettings


class KinematicSettings(RobotSettings):
    """Settings of the robot without physics."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    jaws_stop_at: Radians = Field(
        0.4, ge=0, le=2, description="Angle at which closing jaws stop at a stone [rad]."
    )
    fails_at_s: float | None = Field(
        None, ge=0, description="Mission time at which the machine stops responding [s]."
    )
    datum: tuple[float, float, float] = Field(
        (47.4084, 8.5106, 440.0),
        description="Latitude [deg], longitude [deg], altitude [m] of the map's origin.",
    )
