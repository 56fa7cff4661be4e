"""What `watch:` of a mission file may say: a condition, and what happens when it is broken."""

from collections.abc import Mapping
from typing import Literal

from pydantic import Field, model_validator

from executive.config import Meters, Radians, Seconds, Settings
from executive.machine.machine import Machine

ESTIMATE, TRACKING, JOINT_LIMITS, EFFORT, PRESSURE, GEOFENCE = (
    "estimate",
    "tracking",
    "joint_limits",
    "effort",
    "pressure",
    "geofence",
)

Do = Literal["tell", "hold", "fail", "stop"]

# Settings that do not belong to each `do`: to which they belong
_OWNERS = {"wait": ("hold", "fail"), "settle": ("hold",), "then": ("hold",), "most": ("fail",)}


class Rule(Settings):
    """What happens when a condition is broken."""

    do: Do = Field(
        description="`tell` writes it down; `hold` stops along the path and waits until the "
        "condition holds again; `fail` lets the leaf fail that moves the machine, which stops "
        "along its path; `stop` ends the mission in a safe stop."
    )
    after: Seconds = Field(
        0.0, ge=0, le=60, description="How long it must be broken before that happens [s]."
    )
    wait: Seconds = Field(
        60.0,
        gt=0,
        le=3600,
        description="Longest wait for the condition [s]: of `hold` in the hold, of `fail` after "
        "the leaf has failed.",
    )
    settle: Seconds = Field(
        1.0, ge=0, le=60, description="Of `hold`: how long it must hold before going on [s]."
    )
    then: Literal["stop", "go_on"] = Field(
        "stop", description="Of `hold`: what happens when the wait is over."
    )
    most: int = Field(
        3, ge=1, le=1000, description="Of `fail`: how often in a mission; after that it stops."
    )

    def after_s(self, machine: Machine) -> float:
        """Return how long the condition must be broken on a machine before the rule acts [s]."""
        return self.after

    @model_validator(mode="after")
    def _check_owned(self) -> "Rule":
        for name, owners in _OWNERS.items():
            is_given = getattr(self, name) != type(self).model_fields[name].default
            if is_given and self.do not in owners:
                of = " and ".join(f"`do: {owner}`" for owner in owners)
                raise ValueError(f"{name} belongs to {of}, not to `{self.do}`")
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
    motion = (JOINT_LIMITS, EFFORT, PRESSURE)
    return {**dict.fromkeys((*machine.sensors, *kinds, *motion), Rule), **_OWN}
