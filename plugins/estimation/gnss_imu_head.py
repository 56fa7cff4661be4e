"""A filter that trails the newest inertial sample, and the state at that sample, predicted from it."""

from bisect import insort
from collections import deque

from executive.arrays import Float
from plugins.estimation.cabin_report import CabinReport
from plugins.estimation.correction import Correction
from plugins.estimation.error_state_filter import ErrorStateFilter
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, carry_covariance, propagate, propagate_through

_COVARIANCE_PERIOD_S = 0.049


class TrailingFilter:
    """Uses measurements at their own time and in order, whatever is late by less than the lag.

    Attributes:
        kalman: The filter, `lag_s` behind the head.
        head: The state at the newest sample.
    """

    def __init__(self, kalman: ErrorStateFilter, noise: InertialNoise, lag_s: float, report: CabinReport) -> None:
        self.kalman = kalman
        self.head = kalman.state
        self._noise = noise
        self._lag_s = lag_s
        self._report = report
        self._begin_s = kalman.state.stamp_s
        self._samples: deque[Inertial] = deque()  # newer than the filter
        self._corrections: list[Correction] = []
        self._covariance: tuple[float, Float] | None = None

    def add(self, correction: Correction) -> bool:
        """Take a correction; return whether it is in time. What is older than the first state, that one has in it."""
        if correction.stamp_s > self._begin_s:
            if correction.stamp_s < self.kalman.state.stamp_s:
                return False
            insort(self._corrections, correction)
        return True

    def add_sample(self, sample: Inertial) -> None:
        """Move the filter on, and the head to the sample; where a correction moves the head, the map takes it."""
        self._samples.append(sample)
        predicted = self.head = propagate(self.head, sample, self._noise.gravity_m_s2)
        if self._advance(sample.stamp_s - self._lag_s):
            self.head = propagate_through(self.kalman.state, self._samples, self._noise.gravity_m_s2)
            self._report.correct(predicted, self.head)

    def _advance(self, until_s: float) -> bool:
        """Predict up to a time, correcting on the way by all that was measured until then; return whether any was."""
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

    def covariance(self) -> Float:
        """Return that of the head's error, (15, 15); it grows so slowly that one of up to 50 ms ago is good enough."""
        stamp_s = self.head.stamp_s
        if self._covariance is None or stamp_s - self._covariance[0] >= _COVARIANCE_PERIOD_S:
            ahead_s = stamp_s - self.kalman.state.stamp_s
            P = carry_covariance(self.kalman.state, self.kalman.covariance, self._noise, ahead_s)
            self._covariance = (stamp_s, P)
        return self._covariance[1]
