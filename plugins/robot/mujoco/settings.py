"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from executive_plugins.physics.contact_settings import ContactSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from pydantic import Field

from executive.config import Newtons, Seconds
from executive.interfaces.robot import RobotSettings


class PhysicsSettings(ContactSettings):
    """Contacts, integration step, and gains of the drives."""

    timestep_s: Seconds = Field(0.0025, ge=0.001, le=0.004, description="Integration step [s].")
    servo_rad_s: float = Field(
        25.0, gt=1, le=60, description="Natural frequency of the arm's position servos [rad/s]."
    )
    jaw_stiffness: float = Field(
        4.0, gt=0, le=20, description="Speed of the jaws over their distance from the target [1/s]."
    )
    grip_force_n: Newtons = Field(
        35000.0, gt=0, description="Tip force before the first command [N]."
    )


class MujocoSettings(RobotSettings):
    """Settings of the site, the physics and the sensors."""

    site: SiteSettings = Field(SiteSettings(), description="Ground and stones.")
    physics: PhysicsSettings = Field(PhysicsSettings(), description="Integration and contacts.")
    sensors: SensorSettings = Field(
        SensorSettings(), description="Location on earth, and faults of the sensors."
    )
