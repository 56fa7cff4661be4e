"""What `watch:` of a mission file may say: a condition, and what happens when it is broken."""

from collections.abc import Mapping
from typing import Literal

from pydantic import Field, model_validator

from executive.config import Meters, Radians, Seconds, Settings
from executive.machine.machine import Machine

ESTIMATE, TRACKING, JOINT_LIMITS, EFFORT, GEOFENCE = (
    "estimate",
    "tracking",
    "joint_limits",
    "effort",
    "geofence",
)


class Rule(Settings):
    """What happens when a condition is broken."""

    do: Literal["tell", "hold", "stop"] = Field(
        description="`tell` writes it down; `hold` stops along the path and waits until the "
        "condition holds again; `stop` ends the mission in a safe stop."
    )
    after: Seconds = Field(
        0.0, ge=0, le=60, description="How long it must be broken before that happens [s]."
    )
    wait: Seconds = Field(
        60.0, gt=0, le=3600, description="Of `hold`: longest wait for the condition [s]."
    )
    settle: Seconds = Field(
        1.0, ge=0, le=60, description="Of `hold`: how long it must hold before going on [s]."
    )
    then: Literal["stop", "go_on"] = Field(
        "stop", description="Of `hold`: what happens when the wait is over."
    )

    def after_s(self, machine: Machine) -> float:
        """Return how long the condition must be broken on a machine before the rule acts [s]."""
        return self.after

    @model_validator(mode="after")
    def _check_hold(self) -> "Rule":
        given = sorted(self.model_fields_set & {"wait", "settle", "then"})
        if self.do != "hold" and any(
            getattr(self, name) != type(self).model_fields[name].default for name in given
        ):
            raise ValueError(f"{' and '.join(given)} belong to `do: hold`, not to `{self.do}`")
        return self


class EstimateRule(Rule):
    """When the estimated pose may be used."""

    status: tuple[str, ...] = Field(
        ("GLOBAL",), min_length=1, description="Statuses in which the estimate may be used."
    )
    position_std: Meters = Field(
        0.2, gt=0, description="Largest standard deviation of the position, per axis [m]."
    )
    heading_std: Radians = Field(
        0.05, gt=0, description="Largest standard deviation of the rotation, per axis [rad]."
    )


class TrackingRule(Rule):
    """How long a joint may be off its path: it springs when a stone falls from the jaws."""

    after: Seconds | None = Field(  # type: ignore[assignment]  # the machine's file says it
        None,
        ge=0,
        le=60,
        description="How long it must be broken before that happens [s]; by default the settling "
        "time of the machine's drives.",
    )

    def after_s(self, machine: Machine) -> float:
        return machine.stance.settling_s if self.after is None else self.after


class GeofenceRule(Rule):
    """Where the gripper may be: within a circle in the map."""

    radius: Meters = Field(gt=0, description="Radius of the circle [m].")
    centre: tuple[float, float] = Field((0.0, 0.0), description="Its centre in the map [m].")


Watched = Mapping[str, Rule]  # by condition

_OWN: Mapping[str, type[Rule]] = {
    ESTIMATE: EstimateRule,
    TRACKING: TrackingRule,
    GEOFENCE: GeofenceRule,
}


def conditions_of(machine: Machine) -> Mapping[str, type[Rule]]:
    """Return the class of the rule of each condition that can be watched on a machine.

    A sensor's name or kind is the condition that its good samples keep coming.
    """
    kinds = (sensor.kind for sensor in machine.sensors.values())
    motion = (JOINT_LIMITS, EFFORT)
    return {**dict.fromkeys((*machine.sensors, *kinds, *motion), Rule), **_OWN}
