"""Settings of the motion plugins, apart from them: reading a mission imports no algorithm."""

from collections.abc import Iterator
from typing import ClassVar, Literal

from pydantic import Field

from executive.config import Meters, Radians, Seconds, Settings
from executive.interfaces.declaration import PluginSettings, Refusal
from executive.machine.machine import Machine


class InverseKinematicsSettings(Settings):
    """Tolerances and iterations."""

    position_tolerance_m: Meters = Field(
        0.005, gt=0, le=0.1, description="Largest deviation of position [m]."
    )
    orientation_tolerance_rad: Radians = Field(
        0.06,
        gt=0,
        le=0.5,
        description="Largest deviation of orientation, for arms with few joints [rad].",
    )
    iterations: int = Field(30, ge=5, le=500, description="Largest number of iterations per seed.")
    margin: float = Field(
        0.005, ge=0, le=0.1, description="Distance kept from the joint limits [rad] or [m]."
    )


class HermiteSettings(PluginSettings):
    """Speed, clearances and tolerances of planned motions."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    speed: float = Field(
        0.9, gt=0, le=1, description="Share of the joints' velocity and acceleration limits to use."
    )
    clearance: Meters = Field(
        0.3, ge=0, le=3, description="Height kept above obstacles while travelling [m]."
    )
    contact_tolerance: Meters = Field(
        0.05,
        ge=0,
        le=0.3,
        description="Depth of map points inside arm or stone that is tolerated [m].",
    )
    machine_clearance: Meters = Field(
        0.05,
        ge=0,
        le=0.5,
        description="Distance kept between parts of the machine, and by sweeps from what stands "
        "around, where they can [m].",
    )
    least_arrival: float = Field(
        0.5, gt=0, le=1, description="Least share of the straight arrival that must be in reach."
    )
    load_limits: Literal["fixed", "by_mass"] = Field(
        "fixed",
        description="Limits of velocity and acceleration with a stone: the loaded ones of the "
        "machine's robot.yaml, whatever it weighs; or, once it is weighed, as far from the empty "
        "ones to the loaded ones as its mass is on the way to the payload.",
    )
    held_up_m_s2: float = Field(
        1.0,
        gt=0,
        le=10,
        description="Largest vertical acceleration that one joint gives a held stone [m/s²]: 10 % "
        "of its weight. A grip that just bears the stone at rest slides under more; with less no "
        "grip was shown to hold better.",
    )
    held_sideways_m_s2: float = Field(
        1.2,
        gt=0,
        le=10,
        description="The same horizontally: the load leans by 7°, and is hardly larger.",
    )
    held_ramp: Seconds = Field(
        0.25,
        gt=0,
        le=5,
        description="Least time in which these accelerations set in [s]: a period of the arm's "
        "servo loops, so that they do not swing.",
    )
    lift_capacity: Literal["by_base", "payload", "iso_10567"] = Field(
        "by_base",
        description="Whether paths with a weighed stone keep the rated lift capacity by radius and "
        "side where one does, and draw the stone in for that (ISO 10567); by_base does where the "
        "machine may tip.",
    )
    oil_flow: Literal["free", "limited", "by_machine"] = Field(
        "free",
        description="Whether motions are slowed down where they would ask for more oil than the "
        "pump gives (`hydraulics` of the machine's robot.yaml); by_machine does where the machine "
        "has a pump.",
    )
    inverse_kinematics: InverseKinematicsSettings = Field(
        InverseKinematicsSettings(), description="How positions for a pose are found."
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        if self.oil_flow == "limited" and machine.hydraulics is None:
            told = f"{machine.name} has no hydraulics (in its robot.yaml): choose `free`"
            yield Refusal(("oil_flow",), told)
