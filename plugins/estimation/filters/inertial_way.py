"""Where inertial samples alone take a filter from one of its newest states."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.inertial.exponential import linear_covariance
from executive_plugins.estimation.inertial.state import POSITION
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_prediction import predict_until
from executive_plugins.estimation.live.packing import unpacked
from executive_plugins.estimation.live.propagator import LivePropagator

from executive.arrays import Float

_predict_until = direct(predict_until)


@dataclass(frozen=True, slots=True, eq=False)
class KeptFilter:
    """A filter at one time.

    Attributes:
        block: The filter, shape (1,), dtype `FILTER`.
        first: Number of the first inertial sample that is newer than its state.
    """

    block: Block
    first: int

    @property
    def stamp_s(self) -> float:
        """Time of its state [s]."""
        return float(self.block["sample"]["stamp_s"].item())


class InertialWay:
    """Predicts a filter of some time ago by samples, without the fixes that it has used since.

    A filter that follows fixes moves as these say. Whether odometry or the fixes have moved
    otherwise than the body, the samples tell for as long as their errors are small.
    """

    def __init__(self, propagator: LivePropagator, kept_s: float) -> None:
        """Begin without a filter.

        Args:
            propagator: Has the inertial samples.
            kept_s: For how long a filter is kept [s].
        """
        self._propagator, self._kept_s = propagator, kept_s
        self._filters: deque[KeptFilter] = deque()

    def add(self, kept: KeptFilter) -> None:
        """Keep a filter, and forget those of which none is needed any more."""
        filters = self._filters
        filters.append(kept)
        while len(filters) > 1 and filters[1].stamp_s <= kept.stamp_s - self._kept_s + 1e-6:
            filters.popleft()

    def end(self, from_s: float, until_s: float) -> tuple[Float, Float] | None:
        """Return where samples take the filter of one time until another.

        Args:
            from_s: Time at which the filter was kept [s].
            until_s: The other time [s].

        Returns:
            Position in the map [m], shape (3,), and its covariance, shape (3, 3); None if the
            filter or its samples are not there any more.
        """
        kept = next((one for one in self._filters if abs(one.stamp_s - from_s) < 1e-6), None)
        ring, samples = self._propagator.ring, self._propagator.samples
        if kept is None or kept.first < samples - len(ring):
            return None
        block = kept.block.copy()
        _predict_until(block, ring, kept.first, samples, until_s)
        state, covariance = unpacked(block)
        return state.p_map_imu, np.array(linear_covariance(state, covariance)[POSITION, POSITION])
