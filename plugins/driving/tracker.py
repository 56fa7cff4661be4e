"""Follows a path of the chassis: feedback of the errors across it, and a speed that ends at 0."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import wrap_angle, yaw_of
from executive.machine.driving import Driving
from executive.messages.drive import BasePath, Steering

_BACK_M, _AHEAD_M = 0.5, 2.0  # of the last place: where the machine can be on its path
_THERE_M = 0.03  # so near to an end it is reached; one tick at the lowest speed is 5 mm
_CREEP_M_S = 0.1  # lowest speed before an end
_BRAKING = 0.5  # share of the acceleration limit for planned braking


@dataclass(frozen=True, slots=True)
class Tracker:
    """Steers by the distance from the path and the angle to it, in the path's length.

    With distance e to the left of the path and angle θ to it, a curvature of κ − e/d² − 2θ/d gives
    e″ = −e/d² − 2e′/d in the length travelled: critically damped, whatever the speed. Backwards the
    sign of the second part changes.

    Source: the linearised law of Kanayama et al. 1990, A stable tracking control method for an
    autonomous mobile robot, Sec. III, with its gains per length.

    Attributes:
        limits: Limits of the machine.
        speed_m_s: Wanted speed [m/s].
        return_m: The length d [m].
    """

    limits: Driving
    speed_m_s: float
    return_m: float

    def steer(self, path: BasePath, along_m: float, T_map_base: Float) -> Steering:
        """Return how to drive on; see `DrivePlanner.steer`."""
        first, last = _piece(path, along_m)
        i = _nearest(path, slice(first, last), along_m, T_map_base[:2, 3])
        x, y, yaw = path.poses_map[i]
        direction = int(path.direction[i])
        offset = T_map_base[:2, 3] - (x, y)
        ahead = direction * float(offset @ (np.cos(yaw), np.sin(yaw)))
        aside = float(offset @ (-np.sin(yaw), np.cos(yaw)))
        end_m = float(path.along_m[last - 1])
        now_m = float(np.clip(path.along_m[i] + ahead, path.along_m[first], end_m))
        angle = wrap_angle(yaw_of(T_map_base[:3, :3]) - yaw)
        curvature = (
            float(path.curvature_1_m[i])
            - aside / self.return_m**2
            - direction * 2 * angle / self.return_m
        )
        most = self.limits.max_curvature_1_m
        left_m, speed = end_m - now_m, 0.0
        if left_m > _THERE_M:
            speed = direction * self._speed(left_m)
        elif last < len(path.along_m):
            now_m = float(path.along_m[last])  # the next piece, in the other direction
        else:
            now_m = path.length_m
        return Steering(
            speed, float(np.clip(curvature, -most, most)), now_m, abs(aside), path.length_m - now_m
        )

    def _speed(self, left_m: float) -> float:
        """Return the speed from which the machine stops within a length [m/s]."""
        top = min(self.speed_m_s, self.limits.max_speed_m_s)
        braking = np.sqrt(2 * _BRAKING * self.limits.max_acceleration_m_s2 * left_m)
        return float(min(top, max(_CREEP_M_S, braking)))


def _piece(path: BasePath, along_m: float) -> tuple[int, int]:
    """Return the samples of one direction about a length: the first, and one after the last."""
    i = int(np.searchsorted(path.along_m, along_m, side="right")) - 1
    turns = np.flatnonzero(np.diff(path.direction)) + 1
    k = int(np.searchsorted(turns, i, side="right"))
    ends = [0, *turns.tolist(), len(path.along_m)]
    return ends[k], ends[k + 1]


def _nearest(path: BasePath, piece: slice, along_m: float, place: Float) -> int:
    """Return the sample of a piece that is nearest to a place (2,), about a length."""
    along = path.along_m[piece]
    near = np.flatnonzero((along >= along_m - _BACK_M) & (along <= along_m + _AHEAD_M))
    near = near if len(near) else np.arange(len(along))
    away = np.linalg.norm(path.poses_map[piece][near, :2] - place, axis=1)
    return int(piece.start) + int(near[int(away.argmin())])
