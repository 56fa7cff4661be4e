"""What a fix says of a filter: whether it is used, and what follows from a doubt."""

import numpy as np
from executive_plugins.estimation.filters.antenna_streams import STEP_AGO_S, AntennaStreams
from executive_plugins.estimation.filters.refused_fixes import TRUSTED
from executive_plugins.estimation.gate.fix_witness import FixWitness
from executive_plugins.estimation.gate.growing_refusals import GrowingRefusals
from executive_plugins.estimation.gate.innovation_record import DOUBTED, LEANS
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import compared
from executive_plugins.estimation.kalman.held_clock import HeldClock, shows_clock
from executive_plugins.estimation.kalman.judged_fix import USED


class FixJudgement:
    """Judges fixes by the newest innovations, and what they tell of the receiver's clock.

    Attributes:
        clock: When the clock is learnt.
        witness: What the fixes say of the error of the reported state.
    """

    def __init__(self, streams: AntennaStreams, gate: float, held_s: float, antennas: int) -> None:
        """Begin without a filter.

        Args:
            streams: The fixes as they come.
            gate: Largest squared Mahalanobis distance of a fix.
            held_s: How long the clock is held after the last doubt, and a fix counts that was in
                doubt and used [s].
            antennas: Number of them.
        """
        self._streams, self._gate, self._held_s = streams, gate, held_s
        self._refusals = GrowingRefusals()
        self.witness = FixWitness(TRUSTED * antennas, held_s)
        self.forget_clock()

    def forget_clock(self) -> None:
        """Forget what a filter knew of the clock: it would contradict the state of another."""
        self.clock = HeldClock(self._held_s)

    def clear_refusals(self) -> None:
        """Forget the fixes that were refused, since one was used."""
        self._refusals.clear()

    def hold_against(self, kalman: ErrorStateFilter, fix: Fix, said: int) -> None:
        """Let the reported covariance hold what a fix says that was compared with a filter.

        Where the clock is known, one in no doubt is corrected by compiled code alone, and is not
        looked at.
        """
        if not kalman.has_clock and said & USED and not said & DOUBTED:
            self.witness.use_sound(1, kalman.stamp_s)
            return
        record, period_s = self._streams.records[fix.antenna], self._streams.period_s(fix.antenna)
        innovation = np.array(kalman.block["residual"][0, :3])
        self.witness.take(innovation, record.covariance, record.white, period_s)

    def judge(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> int:
        """Correct by a fix whose innovation is in no doubt; return what `judged_fix` says."""
        streams, clock = self._streams, self.clock
        is_learnt = (
            kalman.has_clock
            and not clock.is_held(kalman)
            and shows_clock(kalman, fix.arm_imu, streams.shared_period_s(fix.antenna))
        )
        clock_s = kalman.clock_s if is_learnt else 0.0
        said = kalman.use_fix(streams.records[fix.antenna].block, fix, late_s, not is_learnt)
        if is_learnt and not said & DOUBTED:
            clock.remember(kalman.stamp_s, clock_s)
        return said

    def look_into(self, kalman: ErrorStateFilter, fix: Fix, said: int) -> str:
        """Look into a doubt; return what speaks against the state, empty if nothing does.

        The covariance of another fix is compared and scaled. If the newest innovations show that
        the prediction is wrong, its covariance grows by a step of the sensor's biases that
        explains them.
        """
        streams = self._streams
        record, cause = streams.records[fix.antenna], ""
        if record.is_alarmed or record.is_biased:
            how = "farther from" if record.is_alarmed else "farther to one side of"
            cause = (
                f"fixes of {fix.antenna} lie {how} the prediction than their covariance explains"
            )
        self.clock.hold(kalman, streams.ago_s(fix.antenna))
        lean = record.lean if said & LEANS else None
        if lean is not None:
            _, H, by_clock, noise = compared(kalman)
            since_s = max(STEP_AGO_S, lean.lasts * streams.period_s(fix.antenna))
            kalman.explain(lean.innovation, (H, by_clock), noise, since_s, lean.share)
            streams.clear_biases()
        return cause

    def is_used(self, kalman: ErrorStateFilter) -> bool:
        """Use the fix that was compared if it is within the gate, or the prediction runs away.

        In the second case the state's covariance is widened to hold the fix too.
        """
        if kalman.correct_by_compared(self._gate):
            return True
        residual, _, _, noise = compared(kalman)
        if not self._refusals.is_running_away(residual, noise):
            return False
        kalman.fade(kalman.distance2 / len(residual))
        return kalman.correct_by_compared(self._gate)

    @staticmethod
    def off_m(kalman: ErrorStateFilter) -> float:
        """Return how far the fix that was compared is from its prediction [m]."""
        return float(np.linalg.norm(compared(kalman)[0]))
