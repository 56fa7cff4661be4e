"""Filters of sampled signals over time."""

import math
from collections import deque

import numpy as np

from executive.arrays import Float


class RunningMedian:
    """Median over a time span; single outliers have no effect."""

    def __init__(self, span_s: float) -> None:
        self._span_s = span_s
        self._first_s: float | None = None
        self._samples: deque[tuple[float, float]] = deque()

    def add(self, stamp_s: float, value: float) -> float | None:
        """Add a sample; return the median, or None until the span is covered."""
        self._first_s = stamp_s if self._first_s is None else self._first_s
        self._samples.append((stamp_s, value))
        while stamp_s - self._samples[0][0] > self._span_s:
            self._samples.popleft()
        if stamp_s - self._first_s < self._span_s:
            return None
        return float(np.median([value for _, value in self._samples]))


class LowPass:
    """First-order low-pass filter of a vector signal with uneven sampling."""

    def __init__(self, time_constant_s: float) -> None:
        self._time_constant_s = time_constant_s
        self._stamp_s = 0.0
        self._value: Float | None = None

    def add(self, stamp_s: float, value: Float) -> tuple[Float, Float]:
        """Add a sample; return the filtered signal and its rate of change."""
        if self._value is None:
            self._stamp_s, self._value = stamp_s, np.array(value)
            return self._value, np.zeros_like(self._value)
        share = 1.0 - math.exp(-max(stamp_s - self._stamp_s, 0.0) / self._time_constant_s)
        rate = (value - self._value) / self._time_constant_s
        self._stamp_s, self._value = stamp_s, self._value + share * (value - self._value)
        return self._value, rate
