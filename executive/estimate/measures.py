"""Accuracy measures of a replayed estimate (Nubert 2022, Sec. V), from states and fixes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from executive.arrays import Bool, Float
from executive.estimate.drop import Drop
from executive.geometry.geodesy import enu_from_geodetic
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix

_NEAR_S = 0.05  # a state is extrapolated to a fix over at most this time, by its velocity
_SETTLED_S = 0.15  # time after a fix by which an estimator that trails by 0.1 s has used it


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """The states of a replay as arrays, n of them.

    Attributes:
        stamps_s: [s], shape (n,).
        T_map_base, T_odom_base, T_map_cabin: Shape (n, 4, 4).
        v_map_cabin: [m/s], shape (n, 3).
        w_map_cabin_in_cabin: [rad/s], shape (n, 3).
    """

    stamps_s: Float
    T_map_base: Float
    T_odom_base: Float
    T_map_cabin: Float
    v_map_cabin: Float
    w_map_cabin_in_cabin: Float

    @classmethod
    def of(cls, states: Sequence[BaseState]) -> "Track":
        """Stack states; at least one is needed."""
        names = ("T_map_base", "T_odom_base", "T_map_cabin", "v_map_cabin", "w_map_cabin_in_cabin")
        stacks = {name: np.stack([getattr(state, name) for state in states]) for name in names}
        return cls(stamps_s=np.array([state.stamp_s for state in states]), **stacks)

    @property
    def T_map_odom(self) -> Float:
        """Pose of the odometry frame in the map, shape (n, 4, 4)."""
        return np.asarray(self.T_map_base @ np.linalg.inv(self.T_odom_base))


@dataclass(frozen=True, slots=True, eq=False)
class FixErrors:
    """Estimated minus measured positions of the antennas at the fixes, m of them.

    Attributes:
        stamps_s: [s], shape (m,).
        p_map_antenna: The measured positions [m], shape (m, 3).
        predicted_m: Error of the state before the fix was used, shape (m, 3).
        posterior_m: Error of the state at the same time after the fix was used, shape (m, 3).
        is_dropped: Whether the fix was withheld from the estimator, shape (m,).
        antennas: Name of each fix's antenna, m of them.
    """

    stamps_s: Float
    p_map_antenna: Float
    predicted_m: Float
    posterior_m: Float
    is_dropped: Bool
    antennas: tuple[str, ...]


def fix_errors(
    track: Track, fixes: Sequence[GnssFix], rig: Rig, datum: Float, drops: Sequence[Drop]
) -> FixErrors:
    """Compare the track with every fix that has a state shortly before it and one after it."""
    T_map_odom = track.T_map_odom
    rows, antennas = [], []
    for fix in fixes:
        before = int(np.searchsorted(track.stamps_s, fix.stamp_s, side="left")) - 1
        after = int(np.searchsorted(track.stamps_s, fix.stamp_s + _SETTLED_S))
        if (
            before < 0
            or after >= len(track.stamps_s)
            or fix.stamp_s - track.stamps_s[before] > _NEAR_S
        ):
            continue
        sensor = rig.sensors[fix.antenna]
        T = track.T_map_cabin[before] if sensor.link == rig.cabin_link else track.T_map_base[before]
        arm = sensor.T_link_sensor[:3, 3]
        turning = track.T_map_cabin[before, :3, :3] @ np.cross(
            track.w_map_cabin_in_cabin[before], arm
        )
        ahead_s = fix.stamp_s - track.stamps_s[before]
        predicted = T[:3, :3] @ arm + T[:3, 3] + ahead_s * (track.v_map_cabin[before] + turning)
        correction = T_map_odom[after] @ np.linalg.inv(T_map_odom[before])
        posterior = correction[:3, :3] @ predicted + correction[:3, 3]
        measured = enu_from_geodetic(fix.geodetic, datum)
        is_dropped = any(drop.takes(fix) for drop in drops)
        antennas.append(fix.antenna)
        rows.append(
            [fix.stamp_s, *measured, *(predicted - measured), *(posterior - measured), is_dropped]
        )
    table = np.array(rows, dtype=float).reshape(-1, 11)
    return FixErrors(
        table[:, 0], table[:, 1:4], table[:, 4:7], table[:, 7:10], table[:, 10] > 0, tuple(antennas)
    )


def consistency(track: Track) -> Float:
    """Return how far each correction moved the pose at its own time [m] (Nubert 2022, Sec. V-B1).

    The pose in the odometry frame is the propagated one, so that any change of T_map_odom is a
    correction.
    """
    T_map_odom = track.T_map_odom
    p_odom = track.T_odom_base[1:, :3, 3]
    propagated = np.einsum("nij,nj->ni", T_map_odom[:-1, :3, :3], p_odom) + T_map_odom[:-1, :3, 3]
    steps = np.linalg.norm(propagated - track.T_map_base[1:, :3, 3], axis=1)
    return np.asarray(steps[steps > 1e-6])  # smaller steps are rounding, not corrections


def outages(errors: FixErrors, drops: Sequence[Drop]) -> list[dict[str, Any]]:
    """Return the position error in each outage of the satellites, against the withheld fixes."""
    answers = []
    for drop in drops:
        inside = (
            (errors.stamps_s >= drop.from_s) & (errors.stamps_s < drop.to_s) & errors.is_dropped
        )
        if not inside.any() or drop.sensor not in ("gnss", *errors.antennas):
            continue
        distance = np.linalg.norm(errors.predicted_m[inside], axis=1)
        # The distance is measured by one antenna; a path through two would zigzag.
        first = np.array([antenna == errors.antennas[0] for antenna in errors.antennas])
        way = float(
            np.linalg.norm(np.diff(errors.p_map_antenna[inside & first], axis=0), axis=1).sum()
        )
        answers.append(
            {
                "sensor": drop.sensor,
                "from_s": drop.from_s,
                "to_s": drop.to_s,
                "error_at_end_m": round(float(distance[-1]), 4),
                "max_error_m": round(float(distance.max()), 4),
                "way_m": round(way, 2),
            }
        )
    return answers


def spread(vectors: Float) -> Mapping[str, float | int]:
    """Return statistics of errors (n, 3): of their length, and the std of a component."""
    if not len(vectors):
        return {"n": 0}
    distance = np.linalg.norm(vectors, axis=1)
    return {**statistics(distance), "std": round(float(vectors.std(axis=0).mean()), 5)}


def statistics(values: Float, digits: int = 5) -> Mapping[str, float | int]:
    """Return mean, standard deviation, 95 and 99 %, largest value and number of values (n,)."""
    if not len(values):
        return {"n": 0}
    figures = {
        "mean": values.mean(),
        "std": values.std(),
        "p95": np.percentile(values, 95),
        "p99": np.percentile(values, 99),
        "max": values.max(),
    }
    return {
        **{name: round(float(value), digits) for name, value in figures.items()},
        "n": len(values),
    }
