"""Estimation by the cabin's inertial sensor, the satellite antennas and the turn joint."""

from collections.abc import Callable, Mapping

import numpy as np
from executive_plugins.estimation.cabin.estimator import UNKNOWN_BODY_GATE, CabinEstimator
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.filters.settings import GnssImuSettings
from executive_plugins.estimation.filters.status_account import (
    FALLBACK,
    GLOBAL,
    SUSPECT,
    StatusAccount,
)
from executive_plugins.estimation.gate.calm_scale import CalmScale
from executive_plugins.estimation.gate.frozen_samples import FrozenSamples
from executive_plugins.estimation.gate.growing_refusals import GrowingRefusals
from executive_plugins.estimation.gate.innovation_alarm import WINDOW, InnovationAlarm
from executive_plugins.estimation.gate.innovation_bias import InnovationBias, Lean
from executive_plugins.estimation.gate.innovation_scale import LARGEST_SCALE, InnovationScale
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.inertial.measurement_models import (
    rate_residual,
    standstill_residual,
)
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from executive_plugins.estimation.kalman.held_clock import HeldClock
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.window_start import WindowStart

from executive.arrays import Float
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

_TRUSTED = 3  # fixes in a row within the gate that end a doubt about the state
_STEP_AGO_S = 1.0  # by which a step of the biases may have begun to show
_DOUBT_S = 2.0  # time after a motion of the chassis during which standstill is ignored


class GnssImuFilter(CabinEstimator):
    """An error-state Kalman filter on the cabin; the antennas' lever arms give the heading.

    With one antenna it starts after the first metres of motion, and the heading is observable only
    while the body accelerates.

    It takes the role of the paper's first baseline, the two-state implicit filter, which uses
    inertial and satellite measurements only (Nubert 2022, Sec. V). The filter itself trails by
    `lag_s`, so that delayed measurements are used at their own time and in order. The state at the
    newest inertial sample is predicted from it.
    """

    Settings = GnssImuSettings

    def __init__(self, settings: GnssImuSettings, machine: Rig) -> None:
        super().__init__(settings, machine)
        self._settings = settings

    def start(self) -> None:
        super().start()
        self._account = StatusAccount(self._status_changes)

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        known = super().settings_for(body)
        return known if body.is_described else {**known, "gate": UNKNOWN_BODY_GATE}

    def _restart(self) -> None:
        super()._restart()
        self._trailing: TrailingFilter[ErrorStateFilter] | None = None
        self._used_fix_s = -np.inf
        self._scales: dict[str, InnovationScale] = {}
        self._biases: dict[str, InnovationBias] = {}
        self._alarms: dict[str, InnovationAlarm] = {}
        self._calm: dict[str, CalmScale] = {}
        self._periods: dict[str, StreamPeriod] = {}
        # Time without a used fix after which fixes are missing [s].
        self._missing_after_s = self._settings.fallback_after_s
        self._doubt: WindowStart | None = None
        self._doubted_s, self._used_in_row = np.inf, 0
        self._suspected_s = -np.inf  # when something last spoke against the state
        self._moving_s = -np.inf
        self._clock = HeldClock(self._settings.reacquire_after_s)
        self._frozen = FrozenSamples()
        self._refusals = GrowingRefusals()

    def _start_at(self, found: Found) -> None:
        settings, kalman = self._settings, self._make_filter(found)
        kalman.agreeing_clock = self._agreeing_clock()
        self._trailing = TrailingFilter(kalman, settings.lag_s, self._propagator)
        self._used_fix_s = found.state.stamp_s
        self._scales = {name: InnovationScale(3, found.fix_scale) for name in self._antennas_imu}
        self._biases = {name: InnovationBias(3) for name in self._antennas_imu}
        self._alarms = {name: InnovationAlarm(3) for name in self._antennas_imu}
        self._calm = {
            name: CalmScale(settings.reacquire_after_s, found.fix_scale)
            for name in self._antennas_imu
        }

    def _make_filter(self, found: Found) -> ErrorStateFilter:
        return ErrorStateFilter(found.state, found.covariance, self._noise, found.clock)

    def _sampled(self, sample: ImuSample, since_last_s: float, answered: int) -> None:
        if self._trailing is not None:
            rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
            unknown_s = max(since_last_s, self._frozen.lasts_s(sample))
            inertial = Inertial(sample.stamp_s, rate, force, unknown_s)
            self._trailing.add_sample(inertial)
            self._follow_doubt(inertial)

    def _admits_fix(self, fix: GnssFix) -> bool:
        return self._stamp_gate.admits(fix.antenna, fix.stamp_s)

    def _use_fix(self, fix: GnssFix, p_map_antenna: Float, noise: Float) -> None:
        antenna, stamp_s = fix.antenna, fix.stamp_s
        self._periods.setdefault(antenna, StreamPeriod()).add(stamp_s)
        usual_s = min(period.missing_after_s for period in self._periods.values())
        self._missing_after_s = max(self._settings.fallback_after_s, usual_s)
        position = Fix(stamp_s, antenna, self._antennas_imu[antenna], p_map_antenna, noise)
        if self._doubt is not None:
            self._doubt.add_fix(position)
        late_s = 0.0 if self._trailing is None else self._trailing.kalman.clock_s
        self._queue(
            antenna, stamp_s - late_s, lambda at: self._correct_by_fix(at, position, late_s)
        )

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Do nothing: this filter does not use lidar."""

    def _use_standing(self, stamp_s: float, rate_cabin: Float) -> None:
        self._queue("joints", stamp_s, lambda at: self._correct_by_standing(at, rate_cabin))

    def _queue(
        self, stream: str, stamp_s: float, apply: Callable[[ErrorStateFilter], None]
    ) -> None:
        trailing = self._trailing
        if trailing is not None and not trailing.add(
            Correction(stamp_s, lambda: apply(trailing.kalman))
        ):
            self._stamp_gate.refuse(stream, "too late")

    def _correct_by_fix(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> None:
        """Correct by a fix at the time by which the clock was thought to be late."""
        antenna = fix.antenna
        residual, H, by_clock, noise = fix_residual(kalman, fix, late_s)
        noise = self._judged(kalman, antenna, residual, (H, by_clock), noise)
        self._hold_both(kalman, residual, kalman.predicted(H, by_clock), noise)
        if kalman.correct(residual, H, noise, self._settings.gate, by_clock):
            self._used_fix_s = max(self._used_fix_s, kalman.state.stamp_s)
            self._used_in_row += 1
            self._refusals.clear()
            if self._used_in_row >= _TRUSTED:
                self._begin_trust()
            return
        self._stamp_gate.refuse(antenna, "outlier")
        self._used_in_row = 0
        if self._doubt is None:
            self._doubt = WindowStart(
                self._settings.window_start.of_doubt(), self._noise, self._settings.clock_std_s
            )
            self._doubted_s = kalman.state.stamp_s
            return
        # One fix in 15,000 is beyond the gate by chance, every few minutes of a mission: it is
        # refused, and speaks against the state only with a second one.
        off_m = float(np.linalg.norm(residual))
        words = f"two fixes were refused, that of {antenna} by {off_m:.2f} m"
        self._suspect(kalman.state.stamp_s, words)

    def _suspect(self, stamp_s: float, cause: str) -> None:
        """Take what speaks against the state at a time [s]."""
        self._suspected_s = stamp_s
        self._account.doubt(cause)

    def _judged(
        self,
        kalman: ErrorStateFilter,
        antenna: str,
        residual: Float,
        derivatives: tuple[Float, Float | None],
        noise: Float,
    ) -> Float:
        """Return the covariance of a fix that the newest innovations explain, shape (3, 3).

        If they show that the prediction is wrong instead, its covariance grows by a step of the
        sensor's biases that explains them, and the fix errs as was known before.
        """
        predicted = kalman.predicted(*derivatives)
        scale, bias, alarm = self._scales[antenna], self._biases[antenna], self._alarms[antenna]
        known = self._calm[antenna].factor(kalman.state.stamp_s, alarm.is_raised, scale.factor())
        S = predicted + known * noise
        usual_s = self._periods[antenna].period_s
        period_s = usual_s / len(self._periods)
        alarm.add(residual, S, self._settings.gate, period_s)
        distance2 = squared_distance(S, residual)
        is_near = distance2 <= self._settings.gate  # outliers say nothing of the prediction
        if is_near:
            bias.add(residual, S, period_s)
        if alarm.is_raised or bias.is_biased:
            how = "farther from" if alarm.is_raised else "farther to one side of"
            words = f"fixes of {antenna} lie {how} the prediction than their covariance explains"
            self._suspect(kalman.state.stamp_s, words)
        if not is_near or alarm.is_raised or bias.is_biased:
            self._clock.hold(kalman, max(_STEP_AGO_S, WINDOW * usual_s))
        else:
            self._clock.follow(kalman)
        if not is_near or bias.lean is None:
            scale.add(residual, predicted, noise)
            return scale.factor() * noise
        self._explain(kalman, bias.lean, derivatives, known * noise, usual_s)
        return known * noise

    def _explain(
        self,
        kalman: ErrorStateFilter,
        lean: Lean,
        derivatives: tuple[Float, Float | None],
        noise: Float,
        period_s: float,
    ) -> None:
        """Widen the state's covariance by a step of the biases that explains a lean."""
        since_s = max(_STEP_AGO_S, lean.lasts * period_s)
        kalman.explain(lean.innovation, derivatives, noise, since_s, lean.share)
        for bias in self._biases.values():
            bias.clear()

    def _hold_both(
        self, kalman: ErrorStateFilter, residual: Float, predicted: Float, noise: Float
    ) -> None:
        """Widen the state's covariance to hold the fixes too if the prediction runs away."""
        distance2 = squared_distance(predicted + noise, residual)
        is_refused = distance2 > self._settings.gate
        if is_refused and self._refusals.is_running_away(residual, noise):
            kalman.fade(distance2 / len(residual))

    def _begin_trust(self) -> None:
        self._doubt, self._doubted_s = None, np.inf
        self._used_in_row = 0

    def _follow_doubt(self, sample: Inertial) -> None:
        """Begin anew from the fixes that were refused, once they explain the motion by themselves.

        Fixes that contradict the filter for so long, but not each other, are more likely right.
        """
        if self._doubt is None:
            return
        self._doubt.add_sample(sample)
        if sample.stamp_s - self._doubted_s < self._settings.reacquire_after_s:
            return
        found = self._doubt.state()
        if found is not None and found.has_heading and self._explains(found):
            self._start_at(found)
            self._begin_trust()
            self._account.begin_anew()
            self._moving_s = sample.stamp_s  # a wide state would accept any standstill

    def _explains(self, found: Found) -> bool:
        """Return whether the window of a doubt refutes the filter.

        It does not if the filter agrees with the newest fix again, nor if its own fit is so bad
        that the window holds good and wrong fixes.
        """
        return self._used_in_row == 0 and found.fix_scale < LARGEST_SCALE

    def _correct_by_standing(self, kalman: ErrorStateFilter, rate_cabin: Float) -> None:
        """Correct by a chassis at rest, unless the filter contradicts that it is at rest.

        A chassis that drives smoothly looks as if it were at rest. After a contradiction,
        standstill is ignored for `_DOUBT_S`.
        """
        if kalman.state.stamp_s - self._moving_s < _DOUBT_S:
            return
        settings, gate = self._settings.standing, self._settings.gate
        residual, H = standstill_residual(kalman.state, self._T_imu_cabin[:3, 3])
        if not kalman.correct(residual, H, settings.velocity_std_m_s**2 * np.eye(3), gate):
            self._moving_s = kalman.state.stamp_s
            return
        if np.linalg.norm(rate_cabin) < settings.rate_std_rad_s:
            # Differentiated encoder readings are accurate at rest only.
            residual, H = rate_residual(kalman.state, self._T_imu_cabin[:3, :3] @ rate_cabin)
            kalman.correct(residual, H, settings.rate_std_rad_s**2 * np.eye(3), gate)

    def state(self) -> BaseState:
        state = super().state()
        self._account.take(state.status, state.stamp_s, state.stamp_s - self._used_fix_s)
        return state

    def _status(self) -> str:
        if self._propagator.stamp_s - self._used_fix_s > self._missing_after_s:
            return FALLBACK
        trusted_s = self._suspected_s + self._settings.reacquire_after_s
        return SUSPECT if self._propagator.stamp_s < trusted_s else GLOBAL
