"""Events of what is watched: refused observations, broken conditions, holds."""

from dataclasses import dataclass

from executive.events.event import Event


@dataclass(frozen=True, slots=True, eq=False)
class ObservationRefused(Event):
    """An observation cannot be true, and went to no plugin; told when the reason is a new one.

    Attributes:
        sensor: The sensor of the machine.
        reason: Why it cannot be true.
        stamp_s: Its stamp [s].
    """

    sensor: str
    reason: str
    stamp_s: float


@dataclass(frozen=True, slots=True, eq=False)
class SamplesMissing(Event):
    """A sample of a sensor has not come; told of the first, second, fourth, eighth … gap.

    Attributes:
        sensor: The sensor of the machine.
        gaps: Number of the gaps in its stream so far.
    """

    sensor: str
    gaps: int


@dataclass(frozen=True, slots=True, eq=False)
class ConditionBroken(Event):
    """A watched condition no longer holds.

    Attributes:
        condition: A sensor, `estimate`, `tracking`, `joint_limits`, `effort`, `pressure` or
            `geofence`.
        reason: What is wrong.
    """

    condition: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class ConditionRestored(Event):
    """A watched condition holds again, after so many seconds."""

    condition: str
    lasted_s: float


@dataclass(frozen=True, slots=True, eq=False)
class MissionHeld(Event):
    """The mission waits with its machine at rest until a condition holds again."""

    condition: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class MissionWentOn(Event):
    """A hold is over.

    Attributes:
        held_s: How long it lasted, in the machine's time [s].
        reason: Why the mission goes on.
        moved_m: How far the estimate of the chassis has moved over the hold [m].
        turned_rad: By how much it has turned [rad].
    """

    held_s: float
    reason: str
    moved_m: float
    turned_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class ScansNotFused(Event):
    """Scans are not fused into the map from now on, for the pose of the cabin is not known."""

    reason: str
