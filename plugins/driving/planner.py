"""Ways of the chassis: curves of arcs and lines, the first that is free of what the map shows."""

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

import numpy as np
from executive_plugins.driving.check import PathCheck
from executive_plugins.driving.drivable_ground import DrivableGround
from executive_plugins.driving.dubins import Curve, curves
from executive_plugins.driving.footprint import footprint
from executive_plugins.driving.pieces import Piece, joined
from executive_plugins.driving.settings import DubinsSettings
from executive_plugins.driving.tracker import Tracker

from executive.arrays import Float, checked
from executive.errors import DataError
from executive.geometry.rotation import wrap_angle, yaw_of
from executive.interfaces.driving import DrivePlanner
from executive.machine.driving import Driving
from executive.machine.machine import Machine
from executive.messages.drive import BasePath, DrivePlan, DriveRequest, DriveTrouble, Steering

_STEP_M = 0.1  # between the samples of a path
_ASIDE_M = 2.0  # between two detours
_ROOMS_M = (3.0, 6.0)  # driven in the other direction at first
_STILL = 1e-6  # between places that are the same [m] and [rad]


class Dubins(DrivePlanner):
    """Tries the shortest curves forwards and backwards, then detours; deterministic."""

    Settings = DubinsSettings
    latency_s: ClassVar[Mapping[str, float]] = {"plan": 0.5}
    is_stateless = True

    def __init__(self, settings: DubinsSettings, machine: Machine) -> None:
        self._settings, self._machine = settings, machine

    def plan(self, request: DriveRequest) -> DrivePlan:
        limits = self._machine.driving
        if limits is None:
            return _refused(DriveTrouble.REFUSED, f"{self._machine.name} does not drive")
        start = np.append(request.T_map_base[:2, 3], yaw_of(request.T_map_base[:3, :3]))
        check = self._check(request, start, limits)
        first: DrivePlan | None = None
        for goal in request.goals_map:
            if _is_there(start, goal):
                told = "the machine stands there already"
                first = first or _refused(DriveTrouble.REFUSED, told)
                continue
            if (trouble := check.trouble(goal[None])) is not None:
                first = first or _refused(*trouble)
                continue
            for path in self._paths(start, goal, self._settings.wider * limits.least_radius_m):
                trouble = check.trouble(path.poses_map)
                if trouble is None:
                    return DrivePlan(path)
                first = first or _refused(*trouble)
        return first or _refused(DriveTrouble.REFUSED, "no curve leads there")

    def steer(self, path: BasePath, along_m: float, T_map_base: Float) -> Steering:
        T_map_base = checked("T_map_base", T_map_base, 4, 4)
        if self._machine.driving is None:
            raise DataError(f"{self._machine.name} does not drive")
        tracker = Tracker(self._machine.driving, self._settings.speed, self._settings.return_within)
        return tracker.steer(path, along_m, T_map_base)

    def _check(self, request: DriveRequest, start: Float, limits: Driving) -> PathCheck:
        s = self._settings
        foot = footprint(self._machine, s.clearance)
        margin = s.detour + 4 * limits.least_radius_m + foot.radius_m
        points = request.surroundings.points
        places = np.vstack([start[None, :2], request.goals_map[:, :2]])
        shown = np.vstack([start[None, :2] - foot.radius_m, start[None, :2] + foot.radius_m])
        shown = np.vstack([shown, points[:, :2]])  # beyond it nothing is seen
        around = (
            np.maximum(places.min(axis=0) - margin, shown.min(axis=0)),
            np.minimum(places.max(axis=0) + margin, shown.max(axis=0)),
        )
        ground = DrivableGround(points, around, limits.step_m, s.ground)
        ground.vouch(start[:2], s.ground.own_m)
        return PathCheck(self._machine, foot, ground, request.T_map_base, s.ground.least_seen)

    def _paths(self, start: Float, goal: Float, radius_m: float) -> Iterator[BasePath]:
        """Return the paths to one goal, the shortest first: direct ones and detours.

        Each is tried from where the machine stands, and after a straight way in the other
        direction, which makes room for the turn.
        """
        found: list[tuple[Piece, ...]] = []
        for direction in (1, -1):
            here, there = _faced(start, direction), _faced(goal, direction)
            for back_m in (0.0, *_ROOMS_M):
                begin = here - back_m * np.array([np.cos(here[2]), np.sin(here[2]), 0.0])
                back: tuple[Piece, ...] = ()
                if back_m:
                    away = Curve(_faced(here, -1), back_m, (0, 0, 0), (1.0, 0.0, 0.0))
                    back = (Piece(away, -direction),)
                ways: list[tuple[Curve, ...]]
                ways = [(one,) for one in curves(begin, there, radius_m)]
                for middle in self._asides(begin, there):
                    parts = curves(begin, middle, radius_m), curves(middle, there, radius_m)
                    ways.append(tuple(next(part) for part in parts))
                found += [(*back, *(Piece(one, direction) for one in way)) for way in ways]
        return (joined(pieces, _STEP_M) for pieces in sorted(found, key=_length_m))

    def _asides(self, start: Float, goal: Float) -> Iterator[Float]:
        """Yield places (3,) beside the middle of the straight way, for a detour."""
        way = goal[:2] - start[:2]
        heading = float(np.arctan2(way[1], way[0]))
        left = np.array([-np.sin(heading), np.cos(heading)])
        for aside_m in np.arange(_ASIDE_M, self._settings.detour + 1e-9, _ASIDE_M):
            for place_m in (aside_m, -aside_m):
                yield np.append(start[:2] + way / 2 + place_m * left, heading)


def _is_there(start: Float, goal: Float) -> bool:
    """Return whether two places (3,) are the same, whole turns aside."""
    turn = wrap_angle(float(goal[2] - start[2]))
    return float(np.linalg.norm(goal[:2] - start[:2])) < _STILL and abs(turn) < _STILL


def _faced(place: Float, direction: int) -> Float:
    """Return a pose (3,) as it looks in the direction of travel."""
    return place if direction == 1 else place + np.array([0.0, 0.0, np.pi])


def _length_m(pieces: Sequence[Piece]) -> float:
    return sum(piece.curve.length_m for piece in pieces)


def _refused(trouble: DriveTrouble, reason: str) -> DrivePlan:
    return DrivePlan(None, trouble, reason)
