"""The correction of a filter by a chassis at rest, and when that is ignored."""

from functools import partial

import numpy as np
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.queued_filter import StandstillGate
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.start.chassis import ChassisRest


class ChassisAtRest:
    """Corrects by a chassis at rest, unless the filter contradicts that it is at rest.

    A chassis that drives smoothly looks as if it were at rest. After a contradiction, standstill is
    ignored for some time.
    """

    def __init__(self, gate: StandstillGate) -> None:
        """Begin without a contradiction.

        Args:
            gate: When the chassis is taken to be at rest.
        """
        self.gate = gate
        self._moving_s = -np.inf
        self._trailing: TrailingFilter[ErrorStateFilter] | None = None

    def follow(self, trailing: TrailingFilter[ErrorStateFilter]) -> None:
        """Correct a filter from now on, and no other."""
        self._trailing = trailing

    def add(self, rest: ChassisRest) -> bool:
        """Correct the filter; return whether that is in time, or there is no filter."""
        if self._trailing is None:
            return True
        kalman = self._trailing.kalman
        correction = Correction(
            rest.stamp_s,
            partial(self._correct, kalman, rest),
            lambda _: self.ignore(kalman.stamp_s),
        )
        return self._trailing.add_standing(correction, rest)

    def ignore(self, moving_s: float) -> None:
        """Take that the chassis was seen to move at a time [s]."""
        self._moving_s = moving_s
        if self._trailing is not None:
            self._trailing.ignore_standing(moving_s)

    def _correct(self, kalman: ErrorStateFilter, rest: ChassisRest) -> None:
        gate = self.gate
        if kalman.stamp_s - self._moving_s < gate.doubt_s:
            return
        if not kalman.correct_by_standstill(gate.T_imu_cabin, rest, gate.settings, gate.gate):
            self.ignore(kalman.stamp_s)
