"""What the simulated robot is told."""

from pydantic import Field

from executive.interfaces.robot import RobotSettings
from plugins.robot.mujoco.physics import PhysicsSettings
from plugins.robot.mujoco.sensors import SensorSettings
from plugins.robot.mujoco.site import SiteSettings


class MujocoSettings(RobotSettings):
    """A machine on a site, its physics, its sensors."""

    site: SiteSettings = Field(SiteSettings(), description="Ground and stones.")
    physics: PhysicsSettings = Field(PhysicsSettings(), description="Integration and contacts.")
    sensors: SensorSettings = Field(SensorSettings(), description="Faults of the sensors.")
