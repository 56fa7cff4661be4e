"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from executive_plugins.robot.mujoco.sensors.dropout import Dropout
from pydantic import Field

from executive.config import Settings


class SensorSettings(Settings):
    """Location on earth, density of the lidars, and faults."""

    datum: tuple[float, float, float] = Field(
        (47.4084, 8.5106, 440.0),
        description="Origin of the map: latitude [deg], longitude [deg], altitude [m].",
    )
    azimuth_stride: int = Field(
        1, ge=1, le=20, description="Fire only every n-th azimuth step of the lidars."
    )
    dropouts: tuple[Dropout, ...] = Field(
        (), description="Time spans in which a sensor sends nothing."
    )
