"""A filter that trails the newest inertial sample, for measurements that arrive late."""

import math
from bisect import insort
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import ChassisRest

_MARGIN = 1.2  # of the lag over the largest delay so far
_LONGEST_S = 2.0  # a measurement that is later is of no use in time
_COVARIANCE_PERIOD_S = 0.049  # between updates of the propagator's covariance without correction


def _nothing(_: int) -> None:
    """Do nothing."""


@dataclass(order=True, slots=True)
class Correction:
    """A correction that waits until the filter reaches its time; ordered by time.

    Attributes:
        stamp_s: Time of the measurement [s].
        apply: Corrects the filter, whose state is at that time.
        resume: Does what is left to do after compiled code has judged the measurement, given what
            that said; see `QueuedFilter`.
        place: Of the measurement in that filter's memory.
    """

    stamp_s: float
    apply: Callable[[], object] = field(compare=False)
    resume: Callable[[int], object] = field(compare=False, default=_nothing)
    place: int = field(compare=False, default=-1)


class Predicted(Protocol):
    """What trails: a filter, or a bank of them."""

    @property
    def stamp_s(self) -> float:
        """Time of its state [s]."""

    def predict_until(self, ring: Block, first: int, end: int, until_s: float) -> int:
        """Propagate through samples up to a time; see `packed_prediction.predict_until`."""

    def packed(self) -> Block:
        """Return what is reported as a row, with the covariance in map axes, see `packing`."""

    def packed_at(self, ring: Block, first: int, end: int, until_s: float) -> tuple[int, Block]:
        """Do what `predict_until` and then `packed` do."""


K = TypeVar("K", bound=Predicted)


class TrailingFilter(Generic[K]):
    """Uses measurements at their own time and in order, if they are late by less than the lag.

    The lag grows with the delays that are met, up to two seconds.

    Attributes:
        kalman: The filter, by `lag_s` or a little more behind the propagator.
    """

    def __init__(self, kalman: K, lag_s: float, propagator: LivePropagator) -> None:
        self.kalman = kalman
        self._lag_s = lag_s
        self._propagator = propagator
        self._begin_s = kalman.stamp_s
        self._first = propagator.samples  # number of the first sample that is newer than the filter
        self._newest_s = self._begin_s
        self._corrections: list[Correction] = []
        self._next_s = math.inf  # time of the first of them
        self._anchored_s = self._begin_s
        propagator.take(kalman.packed())

    @property
    def first(self) -> int:
        """Number of the first inertial sample that is newer than the filter."""
        return self._first

    def add(self, correction: Correction, is_awaited: bool = True) -> bool:
        """Add a correction; return whether it is in time.

        A correction before the first state is ignored, since that state includes it.

        Args:
            correction: The correction.
            is_awaited: Whether the lag grows if it is late. The state is predicted over the lag,
                and gains more from a short one than from a measurement that it does not need.
        """
        if correction.stamp_s > self._begin_s:
            if correction.stamp_s < self.kalman.stamp_s:
                if is_awaited:
                    self._wait_for(correction.stamp_s)
                return False
            insort(self._corrections, correction)
            self._next_s = self._corrections[0].stamp_s
        return True

    def add_fix(self, correction: Correction, _: Fix, __: int, ___: float) -> bool:
        """Add a correction by a fix; see `QueuedFilter.add_fix`."""
        return self.add(correction)

    def add_standing(self, correction: Correction, _: ChassisRest) -> bool:
        """Add a correction by a chassis at rest; see `QueuedFilter.add_standing`."""
        return self.add(correction)

    def add_look(self, correction: Correction) -> None:
        """Add what only looks at the filter; see `QueuedFilter.add_look`."""
        self.add(correction, is_awaited=False)

    def ignore_standing(self, _: float) -> None:
        """Do nothing: what is added decides itself when it ignores a chassis at rest."""

    def _wait_for(self, stamp_s: float) -> None:
        """Trail by more from now on, so that measurements as late as this one are in time."""
        if self._first < self._propagator.samples:
            late_s = self._newest_s - stamp_s
            self._lag_s = max(self._lag_s, min(_MARGIN * late_s, _LONGEST_S))

    def add_sample(self, stamp_s: float) -> None:
        """Advance the filter and correct the propagator where a sample makes that due.

        The filter is advanced through several samples at once, when a correction is due or the
        propagator's covariance is old: between samples the processor's caches cool, and a step
        alone takes five times as long as one among others.

        Args:
            stamp_s: Time of the sample, which the propagator has taken [s].
        """
        self._newest_s = stamp_s
        is_corrected = self._next_s <= stamp_s - self._lag_s
        if is_corrected or stamp_s - self._anchored_s >= _COVARIANCE_PERIOD_S:
            self.follow()

    def follow(self) -> None:
        """Advance the filter to where it trails the newest sample by the lag, and report it."""
        if self._first == self._propagator.samples:
            return
        until_s = self._newest_s - self._lag_s
        is_corrected = self._next_s <= until_s
        if is_corrected:
            self._correct(until_s)
        self._anchored_s, propagator = self._newest_s, self._propagator
        self._first, estimate = self.kalman.packed_at(
            propagator.ring, self._first, propagator.samples, until_s
        )
        if is_corrected:
            propagator.take(estimate)
        else:
            propagator.anchor(estimate)

    def _correct(self, until_s: float) -> None:
        """Predict to each correction up to a time, and apply it."""
        corrections = self._corrections
        while corrections and corrections[0].stamp_s <= until_s:
            correction = corrections.pop(0)
            self._predict_to(correction.stamp_s)
            correction.apply()
        self._next_s = corrections[0].stamp_s if corrections else math.inf

    def _predict_to(self, stamp_s: float) -> None:
        """Predict to a time, unless the filter is there already [s]."""
        if stamp_s > self.kalman.stamp_s:
            propagator = self._propagator
            self._first = self.kalman.predict_until(
                propagator.ring, self._first, propagator.samples, stamp_s
            )
