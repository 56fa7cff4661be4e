"""Odometry as a witness: whether it has measured the motion that a state has made.

A filter that uses no odometry follows what fixes err slowly, and a sensor that errs little moves it
no farther than the fixes allow. Odometry is not drawn along. It errs as well, so that it decides
nothing: where both motions contradict each other, either may be right.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.filters.inertial_way import InertialWay, KeptFilter
from executive_plugins.estimation.filters.odometry_window import (
    TURN,
    WAY,
    Look,
    OdometryWindow,
)
from executive_plugins.estimation.gate.drift_record import DriftRecord
from executive_plugins.estimation.gate.innovation_alarm import binary, usual_size
from executive_plugins.estimation.gate.likely_error import BEGINS_AFTER_S
from executive_plugins.estimation.live.propagator import LivePropagator

from executive.arrays import Float
from executive.geometry import chi_square
from executive.messages.odometry import LidarIncrement

_PARTS = (8, 4, 2, 1)  # of the time that is remembered: windows over which motions are compared
_LEARNT = 1  # number of the window that tells the usual drift
_SIGMAS = 3.0  # of `DriftRecord.share`
_FALSE_ALARM_S = BEGINS_AFTER_S  # mean time between two contradictions by chance
_USUAL = usual_size(3)


class OdometryWitness:
    """Compares the motion of the newest seconds by a filter and by one stream of odometry.

    Attributes:
        turned2, moved2: Second moments of the state's error if odometry is right, of the rotation
            [rad²] and of the position [m²], map axes, shape (3, 3); zero while chance and the drift
            of odometry explain what differs.
        size2: Sum of both traces, kept because it is asked for at each inertial sample.
    """

    def __init__(self, kept_s: float, propagator: LivePropagator) -> None:
        """Begin without increments.

        Args:
            kept_s: The longest time over which motions are compared [s].
            propagator: Has the inertial samples.
        """
        self._kept_s = kept_s
        self._looks: deque[Look] = deque()
        self._inertial = InertialWay(propagator, kept_s / _PARTS[0])
        self._drift = DriftRecord(kept_s / _PARTS[_LEARNT])
        self.forget()

    @property
    def is_apart(self) -> bool:
        """Whether both motions contradict each other."""
        return any(self._are_apart)

    def forget(self) -> None:
        """Begin anew; what is known of the drift is kept."""
        self._looks.clear()
        self._are_apart = [False, False]  # turns, and ways
        self.turned2: Float = np.zeros((3, 3))
        self.moved2: Float = np.zeros((3, 3))
        self.size2 = 0.0

    def take(self, kept: KeptFilter, increment: LidarIncrement, is_sound: bool) -> None:
        """Take an increment at its end.

        Args:
            kept: The filter at that time.
            increment: The motion of the IMU.
            is_sound: Whether nothing else speaks against the state.
        """
        looks, block = self._looks, kept.block
        self._inertial.add(kept)
        if not looks or abs(looks[-1].stamp_s - increment.from_s) > 1e-6:
            self.forget()
            looks.append(Look.at(block))
            return
        looks.append(looks[-1].after(block, increment))
        while looks[1].stamp_s < looks[-1].stamp_s - self._kept_s:
            looks.popleft()
        windows = list(self._windows())
        limit = _limit(binary(looks[-1].stamp_s - increment.from_s))
        if is_sound and windows and self._is_refuted(windows[0], limit):
            self.forget()
            return
        self.turned2 = self._judged(TURN, windows, limit, self.turned2)
        self.moved2 = self._judged(WAY, windows, limit, self.moved2)
        self.size2 = float(np.trace(self.moved2) + np.trace(self.turned2))
        if is_sound and len(windows) > _LEARNT:
            self._learn(windows[_LEARNT])

    def _windows(self) -> Iterator[OdometryWindow]:
        """Yield the windows that are remembered, the shortest first."""
        end, drift = self._looks[-1], self._drift.share / _SIGMAS
        for parts in _PARTS:
            begin_s = end.stamp_s - self._kept_s / parts + 1e-6
            begin = next((one for one in reversed(self._looks) if one.stamp_s <= begin_s), None)
            if begin is None:
                return
            yield OdometryWindow(begin, end, drift)

    def _judged(
        self, part: slice, windows: Sequence[OdometryWindow], limit: float, known: Float
    ) -> Float:
        """Return the largest second moment of what differs; zero while all windows are usual.

        A contradiction begins beyond a limit, and ends when all windows are usual again. Before it
        begins, an error counts by its probability. What is older than the windows is not undone.

        Args:
            part: `TURN` or `WAY`.
            windows: What differs.
            limit: See `_limit`.
            known: The answer before.
        """
        number = 0 if part == TURN else 1
        unusual = [one for one in windows if one.distance2(part) > _USUAL]
        bound = _USUAL if self._are_apart[number] else limit
        self._are_apart[number] = any(one.distance2(part) > bound for one in unusual)
        if self._are_apart[number]:
            moments = [one.second_moment(part) for one in unusual]
        else:
            moments = [one.likely_error(part) for one in unusual]
        return max([known, *moments], key=np.trace) if unusual else np.zeros((3, 3))

    def _is_refuted(self, window: OdometryWindow, limit: float) -> bool:
        """Return whether inertial samples refute the way of odometry: the third witness.

        They must contradict it by themselves as well: a filter that is drawn by fixes does not show
        what they tell. Where turns differ, the gyroscope may be wrong, and with it the axes in
        which ways are compared.
        """
        if window.distance2(TURN) > _USUAL or window.carried_distance2() <= limit:
            return False
        found = self._inertial.end(window.begin.stamp_s, window.end.stamp_s)
        if found is None:
            return False
        apart = window.apart[WAY] + found[0] - window.end.p
        return squared_distance(window.covariance(WAY) + found[1], apart) > limit

    def _learn(self, window: OdometryWindow) -> None:
        """Take the drift of a window that is usual, unless noise hides the usual one."""
        noise2 = float(np.trace(window.noise[WAY, WAY]))
        if window.distance2(WAY) <= _USUAL and noise2 < 3 * (window.drift * window.length_m) ** 2:
            excess2 = max(0.0, float(window.apart[WAY] @ window.apart[WAY]) - noise2)
            self._drift.add(window.end.stamp_s, float(np.sqrt(excess2)), window.length_m)


@lru_cache(maxsize=64)
def _limit(period_s: float) -> float:
    """Return the bound on a squared distance that chance exceeds once in `_FALSE_ALARM_S`."""
    return chi_square.bound(period_s / (_FALSE_ALARM_S * 2 * len(_PARTS)), 3)
