"""What `faults:` of a mission file may say: faults of sensors, of actuators and of plugins."""

from typing import Literal

from pydantic import Field, model_validator

from executive.config import Hertz, Seconds
from executive.errors import did_you_mean
from executive.faults.timing import Timing
from executive.machine.machine import Machine

EFFORTS = "efforts"  # the efforts in the joint samples, from the cylinders' pressures
ARM, JAWS = "arm", "jaws"

SensorHow = Literal[
    "silent",
    "stuck",
    "garbage",
    "wrong",
    "slow",
    "delayed",
    "intermittent",
    "nan",
    "duplicate",
    "clock_jump",
    "float",
    "multipath",
    "wrong_fix",
]
_OF_GNSS = ("float", "multipath", "wrong_fix")
_OF_EFFORTS = ("silent", "stuck", "garbage", "wrong", "nan")
# The setting that each kind of fault takes; a setting that it does not use is refused.
_TAKES = {
    "wrong": "offset",
    "multipath": "offset",
    "wrong_fix": "offset",
    "slow": "rate",
    "delayed": "delay",
    "intermittent": "share",
    "clock_jump": "jump",
}


class SensorFault(Timing):
    """A fault of a sensor: its samples are dropped, changed, delayed or repeated."""

    sensor: str = Field(
        description="A sensor of robot.yaml, a kind of sensor (imu, gnss, lidar, encoders), or "
        "`efforts`: those in the joint samples."
    )
    how: SensorHow = Field(description="What is wrong with it.")
    offset: float | None = Field(
        None,
        description="Of `wrong`, `wrong_fix` and `multipath`: added to joints [rad, m], angular "
        "velocities [rad/s], ranges or positions [m]; a share of the largest effort.",
    )
    rate: Hertz | None = Field(None, gt=0, description="Of `slow`: samples a second [Hz].")
    delay: Seconds | None = Field(None, gt=0, description="Of `delayed`: by how much [s].")
    share: float | None = Field(
        None, gt=0, lt=1, description="Of `intermittent`: share of the samples that are lost."
    )
    jump: float | None = Field(
        None, description="Of `clock_jump`: what is added to the stamps [s]; may be negative."
    )

    @model_validator(mode="after")
    def _check_settings(self) -> "SensorFault":
        for name in ("offset", "rate", "delay", "share", "jump"):
            if getattr(self, name) is not None and _TAKES.get(self.how) != name:
                wanted = _TAKES.get(self.how)
                cure = f"it takes {wanted}" if wanted else "it takes no such setting"
                raise ValueError(f"a fault `{self.how}` has no {name}; {cure}")
        if self.sensor == EFFORTS and self.how not in _OF_EFFORTS:
            raise ValueError(f"efforts can be {', '.join(_OF_EFFORTS)}, not {self.how}")
        return self

    @property
    def target(self) -> str:
        return self.sensor

    def refusal(self, machine: Machine) -> tuple[str, str] | None:
        """Return the field and the reason for which a machine cannot have the fault, or None."""
        kinds = sorted({sensor.kind for sensor in machine.sensors.values()})
        known = [*machine.sensors, *kinds, EFFORTS]
        if self.sensor not in known:
            near = did_you_mean(self.sensor, known)
            return "sensor", f"{machine.name} has no sensor '{self.sensor}'{near}"
        found = machine.sensors.get(self.sensor)
        kind = found.kind if found is not None else self.sensor
        if self.how in _OF_GNSS and kind != "gnss":
            return "how", f"`{self.how}` is a fault of satellite receivers, not of {self.sensor}"
        return None


class ActuatorFault(Timing):
    """A fault of a drive: it moves slower than it is told, not at all, or its jaws open."""

    actuator: str = Field(description="A joint of the arm, `arm` for all of them, or `jaws`.")
    how: Literal["sluggish", "no_pressure", "open"] = Field(description="What is wrong with it.")
    share: float | None = Field(
        None, gt=0, lt=1, description="Of `sluggish`: share of the commanded motion; 0.5 if absent."
    )

    @model_validator(mode="after")
    def _check_actuator(self) -> "ActuatorFault":
        if self.how == "open" and self.actuator != JAWS:
            raise ValueError(f"only the jaws can open, not {self.actuator}")
        if self.share is not None and self.how != "sluggish":
            raise ValueError(f"a fault `{self.how}` has no share")
        return self

    @property
    def target(self) -> str:
        return self.actuator

    def refusal(self, machine: Machine) -> tuple[str, str] | None:
        """Return the field and the reason for which a machine cannot have the fault, or None."""
        known = [*machine.arm_names, ARM, JAWS]
        if self.actuator in known:
            return None
        near = did_you_mean(self.actuator, known)
        return "actuator", f"{machine.name} has no actuator '{self.actuator}'{near}"


class PluginFault(Timing):
    """A fault of a plugin: a verb of it raises, hangs, dies, answers late or wrongly."""

    plugin: str = Field(description="Capability whose plugin it is, such as `segmentation`.")
    verb: str = Field(description="Method, such as `segment`.")
    how: Literal["raise", "hang", "die", "late", "nan", "wrong_type"] = Field(
        description="What the verb does instead of its work."
    )
    calls: int | None = Field(
        None, ge=1, description="How many calls fail; all while the fault is active if absent."
    )
    delay: Seconds | None = Field(
        None, gt=0, description="Of `late`: how much later than usual it answers [s]."
    )

    @model_validator(mode="after")
    def _check_delay(self) -> "PluginFault":
        if self.delay is not None and self.how != "late":
            raise ValueError(f"a fault `{self.how}` has no delay")
        return self

    @property
    def target(self) -> str:
        return f"{self.plugin}.{self.verb}"


Fault = SensorFault | ActuatorFault | PluginFault

# The key that says what a fault is of, and the settings that go with it.
KINDS: dict[str, type[SensorFault] | type[ActuatorFault] | type[PluginFault]] = {
    "sensor": SensorFault,
    "actuator": ActuatorFault,
    "plugin": PluginFault,
}
