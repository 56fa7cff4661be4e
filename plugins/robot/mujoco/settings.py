"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from executive_plugins.physics.scenario import Scenario
from executive_plugins.robot.mujoco.physics_settings import LegSettings, PhysicsSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from pydantic import Field

from executive.errors import did_you_mean
from executive.interfaces.declaration import Refusal
from executive.interfaces.robot import RobotSettings
from executive.machine.machine import Machine


class MujocoSettings(RobotSettings):
    """Settings of the site, the physics and the sensors."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "rng")
    is_simulated: ClassVar[bool] = True
    gives: ClassVar[tuple[str, ...]] = ("scene", "photographs")

    scenario: Scenario = Field(
        "nominal", description="Physics of the world, from kind to harsh; see docs/simulator.md."
    )
    base: Literal["by_scenario", "welded", "on_legs", "on_wheels"] = Field(
        "by_scenario",
        description="Whether the chassis is fixed to the ground, stands on its legs (it sways, may "
        "tip, and raises them to drive), or on its wheels alone (it drives). `by_scenario` is "
        "`welded` in `kind`, and `on_legs` in the others.",
    )
    drive: Literal["servo", "hydraulic"] = Field(
        "servo",
        description="What moves the joints of the arm: servos without delay; or cylinders behind "
        "valves with dead time, lag and dead band, from `hydraulics` of the machine's robot.yaml.",
    )
    legs: LegSettings = Field(LegSettings(), description="How the legs yield, with `on_legs`.")
    site: SiteSettings = Field(SiteSettings(), description="Ground and stones.")
    physics: PhysicsSettings = Field(PhysicsSettings(), description="Integration and contacts.")
    sensors: SensorSettings = Field(
        SensorSettings(), description="Location on earth, and faults of the sensors."
    )

    @property
    def footing(self) -> Literal["welded", "on_legs", "on_wheels"]:
        """What the chassis stands on in this scenario."""
        if self.base != "by_scenario":
            return self.base
        return "welded" if self.scenario == "kind" else "on_legs"

    @property
    def may_tip(self) -> bool:
        return self.footing != "welded"

    @property
    def support_n_m(self) -> float | None:
        return self.legs.stiffness_n_m if self.footing == "on_legs" else None

    @property
    def legs_s(self) -> float:
        return self.legs.longest_s if self.footing == "on_legs" else 0.0

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        for i, dropout in enumerate(self.sensors.dropouts):
            if dropout.sensor not in machine.sensors:
                near = did_you_mean(dropout.sensor, machine.sensors)
                told = f"{machine.name} has no sensor '{dropout.sensor}'{near}"
                yield Refusal(("sensors", "dropouts", i, "sensor"), told)
        if self.may_tip and len(machine.stance.supports_m) < 3:
            told = (
                f"{machine.name} has no points of support (stance.supports_m of its robot.yaml): "
                "give them, or choose `welded`"
            )
            yield Refusal(("base",), told)
        if self.footing == "on_wheels" and machine.driving is None:
            yield Refusal(("base",), f"{machine.name} does not drive (driving of its robot.yaml)")
        if self.drive == "hydraulic" and machine.hydraulics is None:
            told = f"{machine.name} has no hydraulics (in its robot.yaml): choose `servo`"
            yield Refusal(("drive",), told)
        folder = self.site.stones.folder
        if folder is not None and not folder.is_dir():
            told = f"'{folder}' is no folder; give one with OBJ, PLY or STL meshes"
            yield Refusal(("site", "stones", "folder"), told)
