"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from pydantic import Field

from executive.interfaces.robot import RobotSettings


class MujocoSettings(RobotSettings):
    """Settings of the site, the physics and the sensors."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "rng")
    gives: ClassVar[tuple[str, ...]] = ("scene", "photographs")

    site: SiteSettings = Field(SiteSettings(), description="Ground and stones.")
    physics: PhysicsSettings = Field(PhysicsSettings(), description="Integration and contacts.")
    sensors: SensorSettings = Field(
        SensorSettings(), description="Location on earth, and faults of the sensors."
    )
