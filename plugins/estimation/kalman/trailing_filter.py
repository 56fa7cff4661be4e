"""A filter that trails the newest inertial sample, for measurements that arrive late."""

from bisect import insort
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.live.propagator import LivePropagator

from executive.arrays import Float

_MARGIN = 1.2  # of the lag over the largest delay so far
_LONGEST_S = 2.0  # a measurement that is later is of no use in time
_COVARIANCE_PERIOD_S = 0.049  # between updates of the propagator's covariance without correction


@dataclass(order=True, frozen=True)
class Correction:
    """A correction that waits until the filter reaches its time; ordered by time.

    Attributes:
        stamp_s: Time of the measurement [s].
        apply: Corrects the filter, whose state is at that time.
    """

    stamp_s: float
    apply: Callable[[], None] = field(compare=False)


class Predicted(Protocol):
    """What trails: a filter, or a bank of them."""

    @property
    def state(self) -> InertialState:
        """Its state."""

    def predict(self, sample: Inertial) -> None:
        """Propagate to a later sample."""

    def reported(self) -> tuple[InertialState, Float]:
        """Return the state that is reported, and its covariance in map axes, shape (15, 15)."""


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
        self._begin_s = kalman.state.stamp_s
        self._samples: deque[Inertial] = deque()  # newer than the filter
        self._corrections: list[Correction] = []
        self._anchored_s = self._begin_s
        propagator.take(packed(*kalman.reported()))

    def add(self, correction: Correction) -> bool:
        """Add a correction; return whether it is in time.

        A correction before the first state is ignored, since that state includes it.
        """
        if correction.stamp_s > self._begin_s:
            if correction.stamp_s < self.kalman.state.stamp_s:
                self._wait_for(correction.stamp_s)
                return False
            insort(self._corrections, correction)
        return True

    def _wait_for(self, stamp_s: float) -> None:
        """Trail by more from now on, so that measurements as late as this one are in time."""
        if self._samples:
            late_s = self._samples[-1].stamp_s - stamp_s
            self._lag_s = max(self._lag_s, min(_MARGIN * late_s, _LONGEST_S))

    def add_sample(self, sample: Inertial) -> None:
        """Take a sample; advance the filter and correct the propagator where that is due.

        The filter is advanced through several samples at once, when a correction is due or the
        propagator's covariance is old: between samples the processor's caches cool, and a step
        alone takes five times as long as one among others.
        """
        self._samples.append(sample)
        if self._is_corrected_by(sample.stamp_s - self._lag_s) or (
            sample.stamp_s - self._anchored_s >= _COVARIANCE_PERIOD_S
        ):
            self.follow()

    def follow(self) -> None:
        """Advance the filter to where it trails the newest sample by the lag, and report it."""
        if not self._samples:
            return
        newest_s = self._samples[-1].stamp_s
        is_corrected = self._is_corrected_by(newest_s - self._lag_s)
        self._advance(newest_s - self._lag_s)
        self._anchored_s = newest_s
        estimate = packed(*self.kalman.reported())
        if is_corrected:
            self._propagator.take(estimate)
        else:
            self._propagator.anchor(estimate)

    def _is_corrected_by(self, until_s: float) -> bool:
        """Return whether a correction is due until a time."""
        return bool(self._corrections) and self._corrections[0].stamp_s <= until_s

    def _advance(self, until_s: float) -> None:
        """Predict up to a time, with all corrections until then."""
        while self._corrections and self._corrections[0].stamp_s <= until_s:
            correction = self._corrections.pop(0)
            self._predict(correction.stamp_s)
            correction.apply()
        self._predict(until_s)

    def _predict(self, until_s: float) -> None:
        while self._samples and self._samples[0].stamp_s <= until_s:
            self.kalman.predict(self._samples.popleft())
        if self._samples and self.kalman.state.stamp_s < until_s:
            self.kalman.predict(self._samples[0].until(until_s))
