"""The hydraulics of a machine: how its valves and cylinders answer a command for speed."""

from pydantic import Field

from executive.config import Seconds
from executive.machine.provenance import Sourced


class Hydraulics(Sourced):
    """Valves, pump and cylinders of the arm, as a controller knows them from identification.

    A machine of the same kind differs from these figures by up to `spread`.
    """

    dead_time_s: Seconds = Field(
        ge=0.01, le=0.5, description="Time from a command until its valve begins to answer [s]."
    )
    lag_hz: float = Field(
        gt=0, le=20, description="Corner frequency of the valve's first-order lag [Hz]."
    )
    dead_band: float = Field(
        ge=0, lt=0.5, description="Share of the full command below which a valve stays closed."
    )
    spread: float = Field(
        ge=0, lt=0.5, description="Largest deviation of one machine from these figures, a share."
    )
    valve_margin: float = Field(
        ge=1, le=3, description="Speed of a joint with its valve fully open over its max_velocity."
    )
    pump_flow_m3_s: float = Field(gt=0, description="Largest flow of the pump [m³/s].")
    displacement: dict[str, float] = Field(
        description="Oil that a joint takes, by its name [m³/rad] or [m³/m]."
    )
    friction: float = Field(
        ge=0, lt=0.2, description="Friction of cylinders and seals as a share of max_effort."
    )
    angle_step_rad: float = Field(ge=0, description="Resolution of an angle's encoder [rad].")
    length_step_m: float = Field(ge=0, description="Resolution of a length's encoder [m].")
