"""Events about driving: where the chassis is sent, and how that ends."""

from dataclasses import dataclass

from executive.arrays import Float
from executive.events.event import Event
from executive.messages.drive import DriveTrouble


@dataclass(frozen=True, slots=True, eq=False)
class DriveStarted(Event):
    """The chassis drives along a path: its goal (x [m], y [m], heading [rad]), and its length."""

    goal_map: Float
    length_m: float


@dataclass(frozen=True, slots=True, eq=False)
class DriveEnded(Event):
    """The chassis stands at its goal, as far off as the estimate says."""

    goal_map: Float
    off_m: float
    off_rad: float
    lasted_s: float


@dataclass(frozen=True, slots=True, eq=False)
class DriveFailed(Event):
    """The chassis does not drive, or was stopped on its way, and why."""

    trouble: DriveTrouble
    reason: str
    T_map_base: Float
