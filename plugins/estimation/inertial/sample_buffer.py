"""Buffer of recent inertial samples, for integration between any two times."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator

import numpy as np
from executive_plugins.estimation.inertial.state import Inertial

from executive.arrays import Float

LONG_GAP_S = 0.1  # over a longer gap, the samples do not describe the motion


class SampleBuffer:
    """Samples in order of time; each is the mean over the time since the one before."""

    def __init__(self) -> None:
        self._stamps_s: list[float] = []
        self._samples: list[Inertial] = []

    def __iter__(self) -> Iterator[Inertial]:
        return iter(self._samples)

    @property
    def newest_s(self) -> float:
        """Time of the newest sample [s]."""
        return self._stamps_s[-1]

    @property
    def oldest_s(self) -> float:
        """Time of the oldest sample [s]."""
        return self._stamps_s[0]

    def arrays(self, from_s: float = -np.inf, to_s: float = np.inf) -> tuple[Float, Float, Float]:
        """Return times [s], (n,), angular velocities and specific forces, shapes (n, 3).

        Args:
            from_s: Of the samples that end at this time or later [s],
            to_s: and before this one [s].
        """
        inside = slice(bisect_left(self._stamps_s, from_s), bisect_left(self._stamps_s, to_s))
        samples = self._samples[inside]
        rates = np.array([sample.rate for sample in samples]).reshape(-1, 3)
        forces = np.array([sample.force for sample in samples]).reshape(-1, 3)
        return np.array(self._stamps_s[inside]), rates, forces

    def append(self, sample: Inertial) -> None:
        """Add a sample that is newer than all others."""
        self._stamps_s.append(sample.stamp_s)
        self._samples.append(sample)

    def at(self, stamp_s: float) -> Inertial:
        """Return the sample that contains a time, cut off at that time.

        A time after the newest sample extends the newest one.
        """
        i = min(bisect_left(self._stamps_s, stamp_s), len(self._samples) - 1)
        return self._samples[i].until(stamp_s)

    def between(self, begin_s: float, end_s: float) -> list[Inertial]:
        """Return the samples between two times, the last one cut off at the later time."""
        if end_s <= begin_s:
            return []
        first, last = bisect_right(self._stamps_s, begin_s), bisect_left(self._stamps_s, end_s)
        return [*self._samples[first:last], self.at(end_s)]

    def ends_at(self, stamp_s: float) -> bool:
        """Return whether a sample ends exactly at a time."""
        i = bisect_left(self._stamps_s, stamp_s)
        return i < len(self._stamps_s) and self._stamps_s[i] == stamp_s

    def forget_before(self, stamp_s: float) -> None:
        """Drop the samples that end before a time."""
        count = bisect_left(self._stamps_s, stamp_s)
        del self._stamps_s[:count], self._samples[:count]
