"""Driving: a request for a path of the chassis, the path, and how to steer along it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from executive.arrays import Float, Int, checked
from executive.errors import DataError
from executive.messages.cloud import Cloud


class DriveTrouble(StrEnum):
    """Why the machine does not drive, or does not drive on."""

    BLOCKED = "blocked"  # something stands in every way
    TOO_STEEP = "too_steep"
    UNSEEN = "unseen"  # the map does not show the ground
    OFF_PATH = "off_path"
    NOT_MOVING = "not_moving"
    ESTIMATE = "estimate"  # the pose is not known well enough
    REFUSED = "refused"  # the machine cannot or does not drive now


@dataclass(frozen=True, slots=True, eq=False)
class DriveRequest:
    """Drive the chassis to the first of several goals to which a free way leads.

    Attributes:
        T_map_base: Present pose of the chassis, shape (4, 4).
        goals_map: Goals in order of preference, each x [m], y [m] and heading [rad] of the base
            frame in the map, shape (k, 3), k ≥ 1.
        surroundings: Ground, stones and obstacles, in the map.
    """

    T_map_base: Float
    goals_map: Float
    surroundings: Cloud

    def __post_init__(self) -> None:
        object.__setattr__(self, "T_map_base", checked("T_map_base", self.T_map_base, 4, 4))
        goals = checked("goals_map", self.goals_map, None, 3)
        if not len(goals):
            raise DataError("a request to drive needs a goal")
        object.__setattr__(self, "goals_map", goals)


@dataclass(frozen=True, slots=True, eq=False)
class BasePath:
    """A path of the chassis over the ground, sampled densely.

    Where the machine reverses, two samples have the same pose: the end of one piece and the start
    of the next.

    Attributes:
        poses_map: x [m], y [m] and heading [rad] of the base frame, shape (n, 3), n ≥ 2.
        along_m: Length of the path up to each sample, never falling, shape (n,).
        curvature_1_m: Curvature at each sample, as in `Drive`, shape (n,).
        direction: 1 where it leads forwards, −1 where backwards, shape (n,).
    """

    poses_map: Float
    along_m: Float
    curvature_1_m: Float
    direction: Int

    def __post_init__(self) -> None:
        poses = checked("poses_map", self.poses_map, None, 3)
        if len(poses) < 2:
            raise DataError("a path of the chassis needs two poses")
        object.__setattr__(self, "poses_map", poses)
        for name in ("along_m", "curvature_1_m"):
            object.__setattr__(self, name, checked(name, getattr(self, name), len(poses)))
        direction = checked("direction", self.direction, len(poses), dtype=np.int64)
        if not (np.abs(direction) == 1).all():
            raise DataError("the direction of a path is 1 or -1 at each pose")
        object.__setattr__(self, "direction", direction)
        if (np.diff(self.along_m) < 0).any():
            raise DataError("the length along a path never falls")

    @property
    def length_m(self) -> float:
        """Length of the whole path [m]."""
        return float(self.along_m[-1])

    @property
    def goal_map(self) -> Float:
        """x [m], y [m] and heading [rad] of its end, shape (3,)."""
        return np.asarray(self.poses_map[-1])


@dataclass(frozen=True, slots=True, eq=False)
class DrivePlan:
    """A path, or why there is none.

    Attributes:
        path: The path, or None.
        trouble: Kind of what is in the way; None with a path.
        reason: The same for a person; empty with a path.
    """

    path: BasePath | None
    trouble: DriveTrouble | None = None
    reason: str = ""

    def __post_init__(self) -> None:
        is_refused = self.trouble is not None and bool(self.reason)
        if (self.path is None) != is_refused:
            raise DataError("a plan to drive has a path, or a trouble and its reason")


@dataclass(frozen=True, slots=True)
class Steering:
    """How to drive now, to follow a path.

    Attributes:
        speed_m_s: Wanted speed, as in `Drive` [m/s].
        curvature_1_m: Wanted curvature [1/m].
        along_m: How far along the path the machine is [m]; given back at the next call.
        off_m: Distance from the path [m].
        left_m: Length of the rest of the path [m].
    """

    speed_m_s: float
    curvature_1_m: float
    along_m: float
    off_m: float
    left_m: float
