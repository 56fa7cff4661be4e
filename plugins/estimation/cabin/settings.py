"""Settings that all estimators of a cabin share."""

from collections.abc import Iterator

from executive_plugins.estimation.start.settings import (
    RestSettings,
    StandstillSettings,
    WindowStartSettings,
)
from pydantic import Field

from executive.config import Seconds
from executive.errors import did_you_mean
from executive.interfaces.declaration import PluginSettings, Refusal
from executive.machine.machine import Machine


class CabinSettings(PluginSettings):
    """Which sensors are used, and their accuracy beyond the machine's description."""

    datum: tuple[float, float, float] | None = Field(
        (47.4084, 8.5106, 440.0),
        description="Origin of the map: latitude [deg], longitude [deg], altitude [m]; null for "
        "the first fix.",
    )
    imu: str = Field("imu_cabin", description="Inertial sensor on the cabin.")
    chassis_imu: str = Field(
        "imu_base", description="Inertial sensor on the chassis; may be missing."
    )
    gravity_m_s2: float = Field(9.81, gt=9.7, lt=9.9, description="Local gravity [m/s²].")
    noise_factor: float = Field(
        2.0, ge=1, le=100, description="Factor on the data sheet's inertial noise, for vibration."
    )
    gnss_scale: float = Field(
        1.0, gt=0, le=10, description="Factor on the fixes' own standard deviation."
    )
    max_gnss_std_m: float = Field(
        30.0, gt=0, le=1000, description="Largest standard deviation of a fix that is used [m]."
    )
    clock_std_s: Seconds = Field(
        0.0,
        ge=0,
        le=1,
        description="Standard deviation of the receiver's clock against the inertial sensor's, "
        "which is then estimated [s]; 0 if both are synchronised.",
    )
    clock_agrees: float = Field(
        0.0,
        ge=0,
        lt=1,
        description="Probability that the receiver's clock agrees with the inertial sensor's, "
        "before anything is measured; without effect where clock_std_s is 0.",
    )
    restart_after_s: Seconds = Field(
        5.0,
        gt=0,
        le=600,
        description="Gap of inertial samples after which the estimate is started again [s].",
    )
    rest: RestSettings = Field(default_factory=RestSettings, description="Initialisation at rest.")
    window_start: WindowStartSettings = Field(
        default_factory=WindowStartSettings, description="Start in motion, and with one antenna."
    )
    standing: StandstillSettings = Field(
        default_factory=StandstillSettings, description="Correction while the chassis is at rest."
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        on_cabin = [s for s in machine.sensors.values() if s.link == machine.cabin_link]
        imus = [s.name for s in on_cabin if s.kind == "imu"]
        if self.imu not in imus:
            near = did_you_mean(self.imu, imus)
            yield Refusal(("imu",), f"'{self.imu}' is no IMU on the cabin of {machine.name}{near}")
        if not any(s.kind == "gnss" for s in on_cabin):
            yield Refusal((), f"{machine.name} has no GNSS antenna on the cabin; one is needed")
