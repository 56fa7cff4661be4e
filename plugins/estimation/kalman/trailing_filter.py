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
        kalman: The filter, `lag_s` behind the propagator.
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
        """Advance the filter after a sample, and correct the propagator where it applies."""
        self._samples.append(sample)
        is_corrected = self._advance(sample.stamp_s - self._lag_s)
        if not is_corrected and sample.stamp_s - self._anchored_s < _COVARIANCE_PERIOD_S:
            return
        self._anchored_s = sample.stamp_s
        estimate = packed(*self.kalman.reported())
        if is_corrected:
            self._propagator.take(estimate)
        else:
            self._propagator.anchor(estimate)

    def _advance(self, until_s: float) -> bool:
        """Predict up to a time with all corrections until then; return whether there were any."""
        is_corrected = False
        while self._corrections and self._corrections[0].stamp_s <= until_s:
            correction = self._corrections.pop(0)
            self._predict(correction.stamp_s)
            correction.apply()
            is_corrected = True
        self._predict(until_s)
        return is_corrected

    def _predict(self, until_s: float) -> None:
        while self._samples and self._samples[0].stamp_s <= until_s:
            self.kalman.predict(self._samples.popleft())
        if self._samples and self.kalman.state.stamp_s < until_s:
            self.kalman.predict(self._samples[0].until(until_s))
