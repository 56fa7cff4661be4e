"""What the simulated robot is told."""

from executive_plugins.robot.mujoco.physics import PhysicsSettings
from executive_plugins.robot.mujoco.sensors import SensorSettings
from executive_plugins.robot.mujoco.site import SiteSettings
from pydantic import Field

from executive.interfaces.robot import RobotSettings


class MujocoSettings(RobotSettings):
    """A machine on a site, its physics, its sensors."""

    site: SiteSettings = Field(SiteSettings(), description="Ground and stones.")
    physics: PhysicsSettings = Field(PhysicsSettings(), description="Integration and contacts.")
    sensors: SensorSettings = Field(SensorSettings(), description="Faults of the sensors.")
