"""The state of before a doubt, kept for as long as the doubt lasts."""

from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.predicted_copy import PredictedCopy
from executive_plugins.estimation.kalman.trailing_filter import TrailingFilter
from executive_plugins.estimation.live.propagator import LivePropagator

_ADVANCED_S = 1.0  # between predictions: less than the propagator's memory of samples


class KeptState:
    """Makes a `PredictedCopy` at the first fix in doubt, and lets the filter return to it."""

    def __init__(self, propagator: LivePropagator, kept_s: float, agreeing: int) -> None:
        """Begin without a doubt.

        Args:
            propagator: Has the inertial samples.
            kept_s: How long the copy is kept after the last doubt [s].
            agreeing: Number of fixes in a row that the filter contradicts and the copy does not,
                after which it returns.
        """
        self._propagator, self._kept_s, self._agreeing = propagator, kept_s, agreeing
        self._copy: PredictedCopy | None = None

    def clear(self) -> None:
        """Forget the copy, since nothing is in doubt."""
        self._copy = None

    def add_fix(self, fix: Fix, scale: float, late_s: float) -> None:
        """Add a fix as it arrives; see `PredictedCopy.add_fix`."""
        if self._copy is not None:
            self._copy.add_fix(fix, scale, late_s)

    def follow(self, now_s: float, doubted_s: float) -> None:
        """Predict the copy while the samples are there; forget it when nothing is in doubt.

        Args:
            now_s: Time of the filter [s].
            doubted_s: When something last spoke against it [s].
        """
        copy = self._copy
        if copy is None:
            return
        if now_s - max(copy.since_s, doubted_s) > self._kept_s:
            self._copy = None
        elif now_s - copy.stamp_s > _ADVANCED_S:
            copy.predict_until(self._propagator.ring, self._propagator.samples, now_s)

    def agree_with_filter(self) -> None:
        """Take that the newest fix agrees with the filter: it is no reason to return."""
        if self._copy is not None:
            self._copy.disagree()

    def take_over(
        self, trailing: TrailingFilter[ErrorStateFilter], fix: Fix, scale: float, late_s: float
    ) -> bool:
        """Hold the copy against a fix in doubt, and let the filter be as it is if it is right.

        Returns:
            Whether the filter has returned; the fix is used then.
        """
        kalman, propagator = trailing.kalman, self._propagator
        copy = self._copy
        if copy is None:
            copy = self._copy = PredictedCopy(kalman, trailing.first)
            copy.add_fix(fix, scale, late_s)
        copy.predict_until(propagator.ring, propagator.samples, kalman.stamp_s)
        if copy.take(kalman, fix, scale, late_s) < self._agreeing:
            return False
        copy.replace(kalman)
        self._copy = None
        return True
