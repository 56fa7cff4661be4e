"""A trailing filter whose waiting corrections are in memory that compiled code reads."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_queue import (
    FIX,
    LEFT_TO_CALLER,
    LOOK,
    NOT_FINITE,
    NOT_PACKED,
    QUEUE,
    REPORTED,
    ROOM,
    STANDING,
    follow_queue,
)
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.live.layout import ESTIMATE
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float

_follow_queue = direct(follow_queue)
_APART = ROOM - 1  # the place of corrections for which there is no room
_NONE = np.zeros(3)
_NOTHING = _NONE, _NONE, np.zeros((3, 3)), 0.0  # of a fix
_NOWHERE = _NONE, 0.0, 0.0  # of a chassis at rest


@dataclass(frozen=True, slots=True, eq=False)
class StandstillGate:
    """When a chassis is taken to be at rest, see `correct_by_standstill`.

    Attributes:
        T_imu_cabin: Cabin in the IMU's frame, shape (4, 4).
        settings: How well it is known then.
        gate: Largest squared Mahalanobis distance that is accepted.
        doubt_s: Time after a contradiction during which standstill is ignored [s].
    """

    T_imu_cabin: Float
    settings: StandstillSettings
    gate: float
    doubt_s: float


class QueuedFilter(TrailingFilter[ErrorStateFilter]):
    """Does what a `TrailingFilter` does, with all corrections of a sample in one compiled call.

    It is for a filter whose clock is known and that is corrected by fixes and standstill alone.
    What speaks against the state is left to Python: the call returns early then, and `resume` of
    the correction is called with what it said.
    """

    def __init__(
        self,
        kalman: ErrorStateFilter,
        lag_s: float,
        propagator: LivePropagator,
        innovations: Block,
        used: Callable[[int, float], None],
    ) -> None:
        """Begin at a filter's state.

        Args:
            kalman: The filter.
            lag_s: By how much it trails the newest sample [s].
            propagator: Reports the state at the newest sample.
            innovations: The newest ones of all antennas, dtype `INNOVATIONS`.
            used: Called with a number of fixes that were used, and the time of the newest [s].
        """
        super().__init__(kalman, lag_s, propagator)
        self._innovations, self._used = innovations, used
        self._queue, self._estimate = np.zeros(1, QUEUE), np.zeros(1, ESTIMATE)
        self._order, self._rows = self._queue["order"][0], self._queue["rows"][0]
        self._rows["kind"][_APART] = NOT_PACKED
        self._free = list(range(_APART))
        # Views of single values: reading one from the row takes twenty times as long.
        self._begin, self._end = self._queue["next"], self._queue["due"]
        self._sample, self._count = self._queue["first"], self._queue["used"]
        self._sample[0] = self._first
        self.ignore_standing(-math.inf)

    def expect_standing(self, standstill: StandstillGate) -> None:
        """Set when a chassis is taken to be at rest."""
        row, settings = self._queue[0], standstill.settings
        row["T_imu_cabin"], row["gate"] = standstill.T_imu_cabin, standstill.gate
        row["doubt_s"] = standstill.doubt_s
        row["velocity_std_m_s"] = settings.velocity_std_m_s
        row["rate_std_rad_s"] = settings.rate_std_rad_s

    def ignore_standing(self, moving_s: float) -> None:
        """Set when the chassis was seen to move last [s]."""
        self._queue["moving_s"] = moving_s

    def add_fix(self, correction: Correction, fix: Fix, place: int, late_s: float) -> bool:
        """Add a correction by a fix; return whether it is in time.

        Args:
            correction: What is done where compiled code does not do it.
            fix: The fix.
            place: Of its antenna among the innovations.
            late_s: By how much its stamp was thought to be late.
        """
        position = fix.arm_imu, fix.p_map_antenna, fix.covariance
        values = correction.stamp_s, FIX, place, *position, late_s, *_NOWHERE
        return self._add(correction, values)

    def add_standing(self, correction: Correction, rest: ChassisRest) -> bool:
        """Add a correction by a chassis at rest, whose cabin turns on it; see `add_fix`."""
        known = rest.rate_cabin, rest.sway_m_s, rest.sway_rad_s
        return self._add(correction, (correction.stamp_s, STANDING, 0, *_NOTHING, *known))

    def add_look(self, correction: Correction) -> None:
        """Add what only looks at the filter: compiled code advances that to its time."""
        values = correction.stamp_s, LOOK, 0, *_NOTHING, *_NOWHERE
        self._add(correction, values, is_awaited=False)

    def _add(
        self, correction: Correction, values: tuple[object, ...], is_awaited: bool = True
    ) -> bool:
        """Add a correction with its row of the queue, see `CORRECTION` and `add`."""
        before = len(self._corrections)
        is_in_time = self.add(correction, is_awaited)
        if len(self._corrections) > before:
            correction.place = self._free.pop() if self._free else _APART
            if correction.place != _APART:
                self._rows[correction.place] = values
            self._arrange()
        return is_in_time

    def _arrange(self) -> None:
        """Write the order of the corrections, as many as there is room for."""
        places = [correction.place for correction in self._corrections[:ROOM]]
        self._order[: len(places)] = places
        self._begin[0] = 0

    def follow(self) -> None:
        propagator = self._propagator
        if self._first == propagator.samples:
            return
        until_s = self._newest_s - self._lag_s
        is_corrected = self._next_s <= until_s
        self._anchored_s = self._newest_s
        said = self._advance(until_s, is_corrected)
        while said not in (REPORTED, NOT_FINITE) or self._next_s <= until_s:
            if said not in (REPORTED, NOT_FINITE):
                self._leave(said)
            said = self._advance(until_s, is_corrected)

    def _advance(self, until_s: float, is_corrected: bool) -> int:
        """Call the compiled code up to a time; return what it says, see `follow_queue`."""
        begin, due = self._begin.item(), self._due(until_s)
        if begin + due > ROOM:
            self._arrange()
            begin = 0
        if due == ROOM:  # there may be more
            until_s = self._corrections[due - 1].stamp_s
        self._end[0] = begin + due
        propagator, kalman = self._propagator, self.kalman
        row, state = propagator.rewritable()
        said: int = _follow_queue(
            *(propagator.block, propagator.ring, kalman.block, self._queue, self._innovations),
            *(self._estimate, row, propagator.samples, until_s, is_corrected),
        )
        kalman.forget_object()
        if said == REPORTED:
            propagator.rewrite(state)
        self._first = self._sample.item()
        self._drop(self._begin.item() - begin)
        if self._count.item():
            self._used(self._count.item(), float(self._queue["used_s"][0]))
        return said

    def _due(self, until_s: float) -> int:
        """Return how many corrections are due, at most those that there is room for."""
        due = 0
        for correction in self._corrections:
            if correction.stamp_s > until_s or due == ROOM:
                break
            due += 1
        return due

    def _drop(self, count: int) -> None:
        """Forget the first corrections, which were applied."""
        if not count:
            return
        corrections = self._corrections
        self._free += [one.place for one in corrections[:count] if one.place != _APART]
        del corrections[:count]
        self._next_s = corrections[0].stamp_s if corrections else math.inf

    def _leave(self, said: int) -> None:
        """Let the first correction do what the compiled code has left to it."""
        correction = self._corrections[0]
        self._begin[0] += 1
        self._drop(1)
        if said == LEFT_TO_CALLER:
            self._predict_to(correction.stamp_s)
            self._sample[0] = self._first
            correction.apply()
        else:
            correction.resume(said)
