"""Estimation by the cabin's inertial sensor, the satellite antennas and the turn joint."""

from collections.abc import Mapping
from functools import partial

import numpy as np
from executive_plugins.estimation.cabin.estimator import UNKNOWN_BODY_GATE, CabinEstimator
from executive_plugins.estimation.filters.kept_state import KeptState
from executive_plugins.estimation.filters.odometry_witnesses import OdometryWitnesses
from executive_plugins.estimation.filters.sensor_trial import SensorTrial
from executive_plugins.estimation.filters.settings import GnssImuSettings
from executive_plugins.estimation.filters.status_account import (
    FALLBACK,
    GLOBAL,
    SUSPECT,
    StatusAccount,
)
from executive_plugins.estimation.gate.frozen_samples import FrozenSamples
from executive_plugins.estimation.gate.growing_refusals import GrowingRefusals
from executive_plugins.estimation.gate.innovation_alarm import WINDOW
from executive_plugins.estimation.gate.innovation_record import (
    DOUBTED,
    INNOVATIONS,
    LEANS,
    InnovationRecord,
)
from executive_plugins.estimation.gate.innovation_scale import LARGEST_SCALE
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import compared
from executive_plugins.estimation.kalman.held_clock import HeldClock, shows_clock
from executive_plugins.estimation.kalman.judged_fix import USED
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.queued_filter import QueuedFilter, StandstillGate
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
    _can_return = True  # to its state of before a doubt

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
        self._innovations: dict[str, InnovationRecord] = {}
        self._periods: dict[str, StreamPeriod] = {}
        # Time without a used fix after which fixes are missing [s].
        self._missing_after_s = self._settings.fallback_after_s
        self._doubt: WindowStart | None = None
        self._doubted_s, self._used_in_row = np.inf, 0
        self._suspected_s = -np.inf  # when something last spoke against the state
        self._moving_s = -np.inf
        self._clock = HeldClock(self._settings.reacquire_after_s)
        kept_s = self._settings.reacquire_after_s
        self._kept = KeptState(self._propagator, kept_s, _TRUSTED)
        self._sensors = SensorTrial(self._propagator, self._noise, kept_s, _TRUSTED)
        self._frozen = FrozenSamples()
        self._refusals = GrowingRefusals()
        self._contradicted_s = -np.inf  # when odometry last shared a doubt
        self._witnesses = OdometryWitnesses(
            self._machine, self._T_imu_cabin, self._antennas_imu, kept_s
        )

    def _start_at(self, found: Found) -> None:
        kalman = self._make_filter(found)
        kalman.agreeing_clock = self._agreeing_clock()
        rows = np.zeros(len(self._antennas_imu), INNOVATIONS)
        self._innovations = self._new_innovations(found, rows)
        self._trailing = self._new_trailing(kalman, rows)
        # What another filter knew of the clock would contradict the state of this one.
        self._clock = HeldClock(self._settings.reacquire_after_s)
        self._used_fix_s = found.state.stamp_s
        self._kept.clear()
        self._sensors.forget()

    def _new_trailing(
        self, kalman: ErrorStateFilter, rows: Block
    ) -> TrailingFilter[ErrorStateFilter]:
        """Return what trails; all of a sample is one compiled call unless more is estimated."""
        settings = self._settings
        if kalman.has_clock or type(kalman) is not ErrorStateFilter:
            return TrailingFilter(kalman, settings.lag_s, self._propagator)
        queued = QueuedFilter(kalman, settings.lag_s, self._propagator, rows, self._count_sound)
        gate = StandstillGate(self._T_imu_cabin, settings.standing, settings.gate, _DOUBT_S)
        queued.expect_standing(gate)
        return queued

    def _new_innovations(self, found: Found, rows: Block) -> dict[str, InnovationRecord]:
        """Return an empty record of innovations for each antenna, over rows of memory."""
        known = self._settings.gate, self._settings.reacquire_after_s, found.fix_scale
        return {
            name: InnovationRecord(*known, rows[k : k + 1])
            for k, name in enumerate(self._antennas_imu)
        }

    def _make_filter(self, found: Found) -> ErrorStateFilter:
        return ErrorStateFilter(found.state, found.covariance, self._noise, found.clock)

    def _sampled(self, sample: ImuSample, since_last_s: float, answered: int) -> None:
        if self._trailing is None:
            return
        frozen_s = self._frozen.lasts_s(sample)
        if frozen_s > since_last_s:
            self._propagator.lengthen(frozen_s)
        self._trailing.add_sample(sample.stamp_s)
        self._kept.follow(self._trailing.kalman.stamp_s, self._suspected_s)
        if self._doubt is not None:
            rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
            unknown_s = max(since_last_s, frozen_s)
            self._follow_doubt(self._doubt, Inertial(sample.stamp_s, rate, force, unknown_s))

    def _admits_fix(self, fix: GnssFix) -> bool:
        return self._stamp_gate.admits(fix.antenna, fix.stamp_s)

    def _use_fix(self, fix: GnssFix, p_map_antenna: Float, noise: Float) -> None:
        antenna, stamp_s = fix.antenna, fix.stamp_s
        self._periods.setdefault(antenna, StreamPeriod()).add(stamp_s)
        usual_s = min(period.missing_after_s for period in self._periods.values())
        self._missing_after_s = max(self._settings.fallback_after_s, usual_s)
        for name, record in self._innovations.items():
            if name in self._periods:
                record.expect(self._periods[name].period_s / len(self._periods))
        position = Fix(stamp_s, antenna, self._antennas_imu[antenna], p_map_antenna, noise)
        if self._doubt is not None:
            self._doubt.add_fix(position)
        trailing = self._trailing
        if trailing is None:
            return
        kalman, late_s = trailing.kalman, trailing.kalman.clock_s
        correction = Correction(
            stamp_s - late_s,
            partial(self._correct_by_fix, kalman, position, late_s),
            partial(self._conclude, kalman, position),
        )
        scale = self._innovations[antenna].known_scale
        self._kept.add_fix(position, scale, late_s)
        if self._can_return:
            self._sensors.add_fix((stamp_s - late_s, position, scale, late_s), self._ago_s(antenna))
            self._sensors.follow(trailing, self._suspected_s)
        place = list(self._innovations).index(antenna)
        if not trailing.add_fix(correction, position, place, late_s):
            self._stamp_gate.refuse(antenna, "too late")

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Hold an increment against the state, which is not corrected by it."""
        trailing, stream = self._trailing, f"odometry {increment.frame}"
        if trailing is None or not self._witnesses.knows(increment.frame):
            return
        if self._stamp_gate.admits(stream, increment.to_s):
            look = partial(self._witness, trailing.kalman, increment)
            trailing.add_apart(Correction(increment.to_s, look))

    def _witness(self, kalman: ErrorStateFilter, increment: LidarIncrement) -> None:
        """Take what odometry says of the state; a doubt does not end while odometry shares it."""
        status = self._status()
        is_apart = self._witnesses.take(kalman, increment, status == GLOBAL)
        if is_apart and status == SUSPECT:
            self._contradicted_s = kalman.stamp_s

    def _use_standing(self, stamp_s: float, rate_cabin: Float) -> None:
        trailing = self._trailing
        if trailing is None:
            return
        kalman = trailing.kalman
        correction = Correction(
            stamp_s,
            partial(self._correct_by_standing, kalman, rate_cabin),
            lambda _: self._ignore_standing(kalman.stamp_s),
        )
        if not trailing.add_standing(correction, rate_cabin):
            self._stamp_gate.refuse("joints", "too late")

    def _correct_by_fix(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> bool:
        """Correct by a fix at the time by which the clock was thought to be late.

        Returns:
            Whether it was used.
        """
        return self._conclude(kalman, fix, self._judge(kalman, fix, late_s), late_s)

    def _conclude(self, kalman: ErrorStateFilter, fix: Fix, said: int, late_s: float = 0.0) -> bool:
        """Do what follows from what `judged_fix` says of a fix; return whether it is used."""
        if not said & DOUBTED:
            self._kept.agree_with_filter()
        elif self._returns(kalman, fix, late_s) or self._finds_wrong_sensor(kalman, fix):
            return True
        if (
            self._is_used(kalman, fix, said)
            or kalman.correct_by_compared(self._settings.gate)
            or self._holds_both(kalman)
        ):
            self._count_used(1, kalman.stamp_s)
            return True
        self._stamp_gate.refuse(fix.antenna, "outlier")
        self._used_in_row = 0
        if self._doubt is None:
            self._doubt = WindowStart(
                self._settings.window_start.of_doubt(), self._noise, self._settings.clock_std_s
            )
            self._doubted_s = kalman.stamp_s
            return False
        # One fix in 15,000 is beyond the gate by chance, every few minutes of a mission: it is
        # refused, and speaks against the state only with a second one.
        off_m = float(np.linalg.norm(compared(kalman)[0]))
        self._suspect(
            kalman.stamp_s, f"two fixes were refused, that of {fix.antenna} by {off_m:.2f} m"
        )
        return False

    def _returns(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> bool:
        """Return to the state of before a doubt if fixes agree with that, and not with the newest.

        Returns:
            Whether the filter did; the fix was used then.
        """
        trailing, scale = self._trailing, self._innovations[fix.antenna].known_scale
        if trailing is None or trailing.kalman is not kalman or not self._can_return:
            return False
        if not self._kept.take_over(trailing, fix, scale, late_s):
            return False
        self._sensors.acquit(kalman)
        self._renew(kalman.stamp_s)
        self._account.go_back()
        return True

    def _finds_wrong_sensor(self, kalman: ErrorStateFilter, fix: Fix) -> bool:
        """Let the filter be as if one inertial sensor erred if that alone explains the fixes.

        Returns:
            Whether the filter is; the fix was used then.
        """
        trailing = self._trailing
        if trailing is None or trailing.kalman is not kalman or not self._can_return:
            return False
        cause = self._sensors.take_over(trailing, fix, self._ago_s(fix.antenna))
        if not cause:
            return False
        self._clock.hold(kalman, 0.0)
        self._renew(kalman.stamp_s)
        self._suspect(kalman.stamp_s, f"the fixes fit {cause}")
        return True

    def _renew(self, stamp_s: float) -> None:
        """Forget what was said of the state before, as another one has used a fix [s]."""
        for record in self._innovations.values():
            record.renew()
        self._used_fix_s = stamp_s
        self._refusals.clear()
        self._begin_trust()

    def _ago_s(self, antenna: str) -> float:
        """Return how long before the fix that shows it an error may have begun [s]."""
        return max(_STEP_AGO_S, WINDOW * self._periods[antenna].period_s)

    def _count_sound(self, count: int, stamp_s: float) -> None:
        """Do what `_count_used` does, for fixes that are in no doubt."""
        self._kept.agree_with_filter()
        self._count_used(count, stamp_s)

    def _count_used(self, count: int, stamp_s: float) -> None:
        """Take that some fixes in a row were used, the last of them at a time [s]."""
        self._used_fix_s = max(self._used_fix_s, stamp_s)
        self._refusals.clear()
        for _ in range(count):
            self._used_in_row += 1
            if self._used_in_row >= _TRUSTED:
                self._begin_trust()

    def _suspect(self, stamp_s: float, cause: str) -> None:
        """Take what speaks against the state at a time [s]."""
        self._suspected_s = stamp_s
        self._account.doubt(cause)

    def _judge(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> int:
        """Correct by a fix whose innovation is in no doubt; return what `judged_fix` says."""
        record, usual_s = self._innovations[fix.antenna], self._periods[fix.antenna].period_s
        is_learnt = (
            kalman.has_clock
            and not self._clock.is_held(kalman)
            and shows_clock(kalman, fix.arm_imu, usual_s / len(self._periods))
        )
        clock_s = kalman.clock_s if is_learnt else 0.0
        said = kalman.use_fix(record.block, fix, late_s, not is_learnt)
        if is_learnt and not said & DOUBTED:
            self._clock.remember(kalman.stamp_s, clock_s)
        return said

    def _is_used(self, kalman: ErrorStateFilter, fix: Fix, said: int) -> bool:
        """Return whether a fix was used; look into a doubt.

        The covariance of another fix is compared and scaled. If the newest innovations show that
        the prediction is wrong, its covariance grows by a step of the sensor's biases that
        explains them.
        """
        if not said & DOUBTED:
            return bool(said & USED)
        record = self._innovations[fix.antenna]
        if record.is_alarmed or record.is_biased:
            how = "farther from" if record.is_alarmed else "farther to one side of"
            words = f"fixes of {fix.antenna} lie {how} the prediction than their covariance"
            self._suspect(kalman.stamp_s, f"{words} explains")
        self._clock.hold(kalman, self._ago_s(fix.antenna))
        lean = record.lean if said & LEANS else None
        if lean is not None:
            _, H, by_clock, noise = compared(kalman)
            since_s = max(_STEP_AGO_S, lean.lasts * self._periods[fix.antenna].period_s)
            kalman.explain(lean.innovation, (H, by_clock), noise, since_s, lean.share)
            for one in self._innovations.values():
                one.clear_bias()
        return False

    def _holds_both(self, kalman: ErrorStateFilter) -> bool:
        """Widen the state's covariance to hold a refused fix too if the prediction runs away.

        Returns:
            Whether the fix was used then.
        """
        residual, _, _, noise = compared(kalman)
        if not self._refusals.is_running_away(residual, noise):
            return False
        kalman.fade(kalman.distance2 / len(residual))
        return kalman.correct_by_compared(self._settings.gate)

    def _begin_trust(self) -> None:
        self._doubt, self._doubted_s = None, np.inf
        self._used_in_row = 0

    def _follow_doubt(self, doubt: WindowStart, sample: Inertial) -> None:
        """Begin anew from the fixes that were refused, once they explain the motion by themselves.

        Fixes that contradict the filter for so long, but not each other, are more likely right.
        """
        doubt.add_sample(sample)
        if sample.stamp_s - self._doubted_s < self._settings.reacquire_after_s:
            return
        found = doubt.state()
        if found is not None and found.has_heading and self._explains(found):
            self._start_at(found)
            self._begin_trust()
            self._account.begin_anew()
            self._ignore_standing(sample.stamp_s)  # a wide state would accept any standstill

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
        if kalman.stamp_s - self._moving_s < _DOUBT_S:
            return
        settings = self._settings
        if not kalman.correct_by_standstill(
            self._T_imu_cabin, rate_cabin, settings.standing, settings.gate
        ):
            self._ignore_standing(kalman.stamp_s)

    def _ignore_standing(self, moving_s: float) -> None:
        """Take that the chassis was seen to move at a time [s]."""
        self._moving_s = moving_s
        if self._trailing is not None:
            self._trailing.ignore_standing(moving_s)

    def state(self) -> BaseState:
        state = self._witnesses.widened(super().state())
        if state.status != self._account.status:
            self._account.take(state.status, state.stamp_s, state.stamp_s - self._used_fix_s)
        return state

    def _status(self) -> str:
        if self._propagator.stamp_s - self._used_fix_s > self._missing_after_s:
            return FALLBACK
        against_s = max(self._suspected_s, self._contradicted_s)
        trusted_s = against_s + self._settings.reacquire_after_s
        return SUSPECT if self._propagator.stamp_s < trusted_s else GLOBAL
