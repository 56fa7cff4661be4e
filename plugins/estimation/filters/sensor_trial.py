"""The trial of the inertial sensors while a filter contradicts the fixes."""

from collections import deque

from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_likelihood import log_likelihood
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.sensor_bank import FixToUse, SensorBank
from executive_plugins.estimation.kalman.sensor_model import SensorModel, attitude_std_rad
from executive_plugins.estimation.kalman.trailing_filter import TrailingFilter
from executive_plugins.estimation.live.propagator import LivePropagator

from executive.arrays import Float

_MARKED_S = 0.25  # between two states that are kept
# Deviation of the attitude beyond which a bias walks no longer: at this one, the mean squared error
# over the covariance is 9.5, where 9 are right (docs/evidence/estimation.md, at the start).
_WIDEST_RAD = 0.3

_Filter = TrailingFilter[ErrorStateFilter]


class SensorTrial:
    """Keeps states of the last second; makes a `SensorBank` of one at the first fix in doubt.

    All of it is done when a fix arrives or is in doubt: an inertial sample takes no longer.
    """

    def __init__(
        self, propagator: LivePropagator, noise: InertialNoise, kept_s: float, agreeing: int
    ) -> None:
        """Begin without a filter.

        Args:
            propagator: Has the inertial samples.
            noise: Noise of sound sensors.
            kept_s: How long the hypotheses are kept after the last doubt [s].
            agreeing: Number of fixes since the first in doubt after which one is adopted.
        """
        self._propagator, self._kept_s, self._agreeing = propagator, kept_s, agreeing
        self._sound: Float = noise.densities
        self.forget()

    def forget(self) -> None:
        """Begin anew, since there is another state."""
        self._marks: deque[tuple[float, Block, int]] = deque()
        self._fixes: deque[FixToUse] = deque()  # since the oldest of them
        self._bank: SensorBank | None = None
        self._begun_s, self._is_open = -float("inf"), False  # whether a bias of the filter walks

    def acquit(self, kalman: ErrorStateFilter) -> None:
        """Take that the sensors are sound; let a filter predict as with these."""
        kalman.block["densities"][0] = self._sound
        self.forget()

    def add_fix(self, fix: FixToUse, since_s: float) -> None:
        """Add a fix as it arrives.

        Args:
            fix: The fix.
            since_s: How long before a doubt an error may have begun [s].
        """
        self._fixes.append(fix)
        if self._bank is not None:
            self._bank.add_fix(fix)
        while self._marks and self._fixes and self._fixes[0][0] <= self._marks[0][0]:
            self._fixes.popleft()
        while len(self._marks) > 1 and self._marks[1][0] <= self._marks[-1][0] - since_s:
            self._marks.popleft()

    def follow(self, trailing: _Filter, doubted_s: float) -> None:
        """Keep a state, and let the filter follow the likeliest hypothesis; end a trial.

        Args:
            trailing: The filter.
            doubted_s: When something last spoke against it [s].
        """
        kalman, now_s = trailing.kalman, trailing.kalman.stamp_s
        if not self._marks or now_s - self._marks[-1][0] >= _MARKED_S:
            self._marks.append((now_s, kalman.block.copy(), trailing.first))
        if self._bank is None and not self._is_open:
            return
        is_wide = self._is_open and attitude_std_rad(kalman.block) > _WIDEST_RAD
        if is_wide or now_s - max(self._begun_s, doubted_s) > self._kept_s:
            self._end(kalman)
        elif self._bank is not None and self._is_lost(self._bank):
            self._bank = None
        elif self._bank is not None:
            self._go_on(self._bank, kalman)

    def _go_on(self, bank: SensorBank, kalman: ErrorStateFilter) -> None:
        """Let the hypotheses use the fixes that the filter has used, and see which is likeliest."""
        bank.follow(self._propagator.ring, self._propagator.samples, kalman.stamp_s)
        chosen = bank.choice(_WIDEST_RAD / 2) if bank.adopted is not None else None
        if chosen is not None and chosen is not bank.adopted:
            self._adopt(bank, chosen, kalman)

    def take_over(self, trailing: _Filter, fix: Fix, since_s: float) -> str:
        """Weigh a fix in doubt, and let the filter be as the hypothesis that explains it.

        Args:
            trailing: The filter, which was compared with the fix and was not corrected by it.
            fix: The fix, which was added before.
            since_s: See `add_fix`.

        Returns:
            What errs by the hypothesis, which has used the fix; empty if the filter is as before.
        """
        kalman, propagator = trailing.kalman, self._propagator
        by_filter, now_s = log_likelihood(kalman.block), kalman.stamp_s
        bank = self._bank
        if bank is not None and bank.is_refuted and now_s - self._begun_s > since_s:
            bank = None
        if bank is None:
            bank = self._begun(kalman, since_s)
        if bank is None:
            return ""
        bank.follow(propagator.ring, propagator.samples, now_s, fix)
        bank.weigh(by_filter, self._agreeing)
        chosen = bank.choice(_WIDEST_RAD / 2)
        if chosen is None:
            return ""
        self._adopt(bank, chosen, kalman)
        return chosen.words

    def _begun(self, kalman: ErrorStateFilter, since_s: float) -> SensorBank | None:
        """Return hypotheses of before the doubt; None if there is no state that is so old.

        A gap in the samples explains a doubt by itself: nothing of the sensors is known over it.
        """
        now_s = kalman.stamp_s
        older = [mark for mark in self._marks if mark[0] <= now_s - since_s]
        if not older or kalman.gap_s > older[-1][0]:
            return None
        stamp_s, block, first = older[-1]
        fixes = [fix for fix in self._fixes if fix[0] > stamp_s]
        bank = SensorBank((block, first), fixes, self._sound, kalman.usual_motion, now_s)
        if self._is_lost(bank):
            return None
        self._bank, self._begun_s = bank, now_s
        return bank

    def _is_lost(self, bank: SensorBank) -> bool:
        """Return whether samples since the bank's states have been written over."""
        return bank.first < self._propagator.samples - len(self._propagator.ring)

    def _adopt(self, bank: SensorBank, chosen: SensorModel, kalman: ErrorStateFilter) -> None:
        """Let the filter be as a hypothesis is."""
        chosen.replace(kalman)
        bank.adopted, self._is_open = chosen, bool(chosen.sensor)

    def _end(self, kalman: ErrorStateFilter) -> None:
        """End a trial; the filter predicts as with sound sensors again."""
        kalman.block["densities"][0] = self._sound
        self._bank, self._is_open = None, False
