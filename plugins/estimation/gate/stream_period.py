"""The usual time between two measurements of a stream, as it is seen."""

import math
from collections import deque
from statistics import median

_COUNT = 5  # intervals; one long gap among them does not change their median
_OVERDUE = 1.5  # periods without a measurement: one did not come
_MISSED = 2.5  # periods without a measurement: two did not come, whatever their jitter


class StreamPeriod:
    """The median of the newest intervals between stamps that increase.

    Attributes:
        period_s: The usual time between two measurements [s]; 0 until there are two, or what was
            given from the first one on.
    """

    def __init__(self, at_first_s: float = 0.0) -> None:
        """Make one without measurements.

        Args:
            at_first_s: What is taken for the usual time after one measurement [s]; 0 for nothing.
        """
        self.period_s, self._at_first_s = 0.0, at_first_s
        self._newest_s = -math.inf
        self._intervals: deque[float] = deque(maxlen=_COUNT)

    def add(self, stamp_s: float) -> None:
        """Take a stamp [s]; one that is not newer than the newest is ignored."""
        since_s = stamp_s - self._newest_s
        if not since_s > 0:
            return
        self._newest_s = stamp_s
        if math.isfinite(since_s):
            self._intervals.append(since_s)
            self.period_s = median(self._intervals)
        else:
            self.period_s = self._at_first_s

    @property
    def overdue_after_s(self) -> float:
        """Time without a measurement after which one did not come [s]; 0 if that is not known."""
        return _OVERDUE * self.period_s

    @property
    def missing_after_s(self) -> float:
        """Time without a measurement after which some are missing [s]; 0 if that is not known."""
        return _MISSED * self.period_s
