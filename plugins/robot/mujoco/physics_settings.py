"""Settings of the simulated world's physics."""

from executive_plugins.physics.contact_settings import ContactSettings
from pydantic import Field

from executive.config import Meters, Newtons, Seconds, Settings
from executive.errors import ConfigError

LEG_TRAVEL_M = 0.6  # of a foot, up and down: a machine 3.3 m long on a slope of 15° needs 0.44


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

    def substeps(self, period_s: float) -> int:
        """Return the number of integration steps in a period.

        Raises:
            ConfigError: If the step does not divide the period.
        """
        substeps = round(period_s / self.timestep_s)
        if abs(substeps * self.timestep_s - period_s) > 1e-9:
            raise ConfigError(
                f"physics.timestep_s must divide {period_s} s, such as 0.002 or 0.0025 s"
            )
        return substeps


class LegSettings(Settings):
    """How far the legs of a machine yield that is not welded to the ground."""

    stiffness_n_m: float = Field(
        2.0e6,
        ge=1e5,
        le=1e8,
        description="Stiffness of one leg [N/m]: a guess for a leg on its foot; a tyre of this "
        "class has 0.33 to 0.65 MN/m.",
    )
    damping_ratio: float = Field(
        0.1, ge=0, le=2, description="Damping of the machine on its legs over the critical one."
    )
    speed_m_s: float = Field(
        0.1,
        gt=0,
        le=1,
        description="How fast a foot is raised before the machine drives, and put down after "
        "[m/s]: a guess.",
    )
    clearance_m: Meters = Field(
        0.15, gt=0, le=0.3, description="Height of the feet above the ground while it drives [m]."
    )

    @property
    def longest_s(self) -> float:
        """How long it takes at most to raise the legs, or to stand on them again [s]."""
        return 2.0 + 1.5 * (self.clearance_m + LEG_TRAVEL_M) / self.speed_m_s
