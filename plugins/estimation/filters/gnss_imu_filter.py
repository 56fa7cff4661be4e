"""Estimation by the cabin's inertial sensor, the satellite antennas and the turn joint."""

from collections.abc import Mapping
from functools import partial

import numpy as np
from executive_plugins.estimation.cabin.estimator import UNKNOWN_BODY_GATE, CabinEstimator
from executive_plugins.estimation.filters.antenna_streams import AntennaStreams, antenna_records
from executive_plugins.estimation.filters.chassis_at_rest import ChassisAtRest
from executive_plugins.estimation.filters.fix_judgement import FixJudgement
from executive_plugins.estimation.filters.inertial_way import KeptFilter
from executive_plugins.estimation.filters.kept_state import KeptState
from executive_plugins.estimation.filters.odometry_witnesses import OdometryWitnesses
from executive_plugins.estimation.filters.refused_fixes import TRUSTED, RefusedFixes
from executive_plugins.estimation.filters.sensor_trial import SensorTrial
from executive_plugins.estimation.filters.settings import GnssImuSettings
from executive_plugins.estimation.filters.status_account import (
    FALLBACK,
    GLOBAL,
    SUSPECT,
    StatusAccount,
)
from executive_plugins.estimation.gate.frozen_samples import FrozenSamples
from executive_plugins.estimation.gate.innovation_record import (
    DOUBTED,
    INNOVATIONS,
    InnovationRecord,
)
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.judged_fix import USED
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.queued_filter import QueuedFilter, StandstillGate
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.found import Found

from executive.arrays import Float
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

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
        settings, kept_s = self._settings, self._settings.reacquire_after_s
        self._trailing: TrailingFilter[ErrorStateFilter] | None = None
        self._used_fix_s = -np.inf
        self._suspected_s = -np.inf  # when something last spoke against the state
        self._contradicted_s = -np.inf  # when odometry last shared a doubt
        self._streams = AntennaStreams(settings.fallback_after_s)
        antennas = len(self._antennas_imu)
        self._fixes = FixJudgement(self._streams, settings.gate, kept_s, antennas)
        self._refused = RefusedFixes(
            settings.window_start, self._noise, settings.clock_std_s, kept_s
        )
        self._chassis = ChassisAtRest(
            StandstillGate(self._T_imu_cabin, settings.standing, settings.gate, _DOUBT_S)
        )
        self._kept = KeptState(self._propagator, kept_s, TRUSTED)
        self._sensors = SensorTrial(self._propagator, self._noise, kept_s, TRUSTED)
        self._frozen = FrozenSamples()
        self._witnesses = OdometryWitnesses(
            self._machine, self._T_imu_cabin, self._antennas_imu, kept_s, self._propagator
        )

    def _start_at(self, found: Found) -> None:
        kalman = self._make_filter(found)
        kalman.agreeing_clock = self._agreeing_clock()
        rows = np.zeros(len(self._antennas_imu), INNOVATIONS)
        self._streams.records = self._new_records(found, rows)
        self._trailing = self._new_trailing(kalman, rows)
        self._chassis.follow(self._trailing)
        self._fixes.forget_clock()
        self._used_fix_s = found.state.stamp_s
        self._kept.clear()
        self._fixes.witness.begin(self._aligning_witness.witness)
        self._sensors.forget()

    def _new_trailing(
        self, kalman: ErrorStateFilter, rows: Block
    ) -> TrailingFilter[ErrorStateFilter]:
        """Return what trails; all of a sample is one compiled call unless more is estimated."""
        settings = self._settings
        if kalman.has_clock or type(kalman) is not ErrorStateFilter:
            return TrailingFilter(kalman, settings.lag_s, self._propagator)
        queued = QueuedFilter(kalman, settings.lag_s, self._propagator, rows, self._count_sound)
        queued.expect_standing(self._chassis.gate)
        return queued

    def _new_records(self, found: Found, rows: Block) -> dict[str, InnovationRecord]:
        """Return an empty record of innovations for each antenna, over rows of memory."""
        known = self._settings.gate, self._settings.reacquire_after_s, found.fix_scale
        return antenna_records(self._antennas_imu, known, rows)

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
        if self._refused.are_awaited:
            rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
            unknown_s = max(since_last_s, frozen_s)
            self._begin_anew(Inertial(sample.stamp_s, rate, force, unknown_s))

    def _begin_anew(self, sample: Inertial) -> None:
        """Begin anew from the fixes that were refused, once they explain the motion."""
        found = self._refused.add_sample(sample)
        if found is not None:
            self._start_at(found)
            self._refused.forget()
            self._account.begin_anew()
            self._chassis.ignore(sample.stamp_s)  # a wide state would accept any standstill

    def _admits_fix(self, fix: GnssFix) -> bool:
        return self._stamp_gate.admits(fix.antenna, fix.stamp_s)

    def _use_fix(self, fix: GnssFix, p_map_antenna: Float, noise: Float) -> None:
        antenna, stamp_s = fix.antenna, fix.stamp_s
        self._streams.add(antenna, stamp_s)
        position = Fix(stamp_s, antenna, self._antennas_imu[antenna], p_map_antenna, noise)
        self._refused.add_fix(position)
        trailing = self._trailing
        if trailing is None:
            return
        kalman, late_s = trailing.kalman, trailing.kalman.clock_s
        correction = Correction(
            stamp_s - late_s,
            partial(self._correct_by_fix, kalman, position, late_s),
            partial(self._conclude, kalman, position),
        )
        scale = self._streams.records[antenna].known_scale
        self._kept.add_fix(position, scale, late_s)
        if self._can_return:
            since_s = self._streams.ago_s(antenna)
            self._sensors.add_fix((stamp_s - late_s, position, scale, late_s), since_s)
            self._sensors.follow(trailing, self._suspected_s)
        if not trailing.add_fix(correction, position, self._streams.place(antenna), late_s):
            self._stamp_gate.refuse(antenna, "too late")

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Hold an increment against the state, which is not corrected by it."""
        trailing, stream = self._trailing, f"odometry {increment.frame}"
        if trailing is None or not self._witnesses.knows(increment.frame):
            return
        # A doubt does not end while odometry shares it.
        apart_s = self._witnesses.compare()
        if self._status() == SUSPECT:
            self._contradicted_s = max(self._contradicted_s, apart_s)
        if self._stamp_gate.admits(stream, increment.to_s):
            look = partial(self._look, trailing, increment)
            trailing.add_look(Correction(increment.to_s, look))

    def _look(self, trailing: TrailingFilter[ErrorStateFilter], increment: LidarIncrement) -> None:
        """Keep the filter at the end of an increment, to be compared."""
        kept = KeptFilter(trailing.kalman.block.copy(), trailing.first)
        self._witnesses.look(kept, increment, self._status() == GLOBAL)

    def _use_standing(self, rest: ChassisRest) -> None:
        if not self._chassis.add(rest):
            self._stamp_gate.refuse("joints", "too late")

    def _correct_by_fix(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> bool:
        """Correct by a fix at the time by which the clock was thought to be late.

        Returns:
            Whether it was used.
        """
        return self._conclude(kalman, fix, self._fixes.judge(kalman, fix, late_s), late_s)

    def _conclude(self, kalman: ErrorStateFilter, fix: Fix, said: int, late_s: float = 0.0) -> bool:
        """Do what follows from what `judged_fix` says of a fix; return whether it is used."""
        self._fixes.hold_against(kalman, fix, said)
        if not said & DOUBTED:
            self._kept.agree_with_filter()
        elif self._returns(kalman, fix, late_s) or self._finds_wrong_sensor(kalman, fix):
            return True
        if said & DOUBTED:
            self._suspect(kalman.stamp_s, self._fixes.look_into(kalman, fix, said))
        if said & USED or self._fixes.is_used(kalman):
            self._fixes.witness.use(kalman.stamp_s)
            self._count_used(1, kalman.stamp_s)
            return True
        self._stamp_gate.refuse(fix.antenna, "outlier")
        # One fix in 15,000 is beyond the gate by chance, every few minutes of a mission: it is
        # refused, and speaks against the state only with a second one.
        if self._refused.refuse(kalman.stamp_s):
            off_m = self._fixes.off_m(kalman)
            cause = f"two fixes were refused, that of {fix.antenna} by {off_m:.2f} m"
            self._suspect(kalman.stamp_s, cause)
        return False

    def _returns(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> bool:
        """Return to the state of before a doubt if fixes agree with that, and not with the newest.

        Returns:
            Whether the filter did; the fix was used then.
        """
        trailing, scale = self._trailing, self._streams.records[fix.antenna].known_scale
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
        cause = self._sensors.take_over(trailing, fix, self._streams.ago_s(fix.antenna))
        if not cause:
            return False
        self._fixes.clock.hold(kalman, 0.0)
        self._renew(kalman.stamp_s)
        self._suspect(kalman.stamp_s, f"the fixes fit {cause}")
        return True

    def _renew(self, stamp_s: float) -> None:
        """Forget what was said of the state before, as another one has used a fix [s]."""
        self._streams.renew()
        self._fixes.witness.clear()
        self._used_fix_s = stamp_s
        self._fixes.clear_refusals()
        self._refused.forget()

    def _count_sound(self, count: int, stamp_s: float) -> None:
        """Do what `_count_used` does, for fixes that are in no doubt."""
        self._kept.agree_with_filter()
        self._fixes.witness.use_sound(count, stamp_s)
        self._count_used(count, stamp_s)

    def _count_used(self, count: int, stamp_s: float) -> None:
        """Take that some fixes in a row were used, the last of them at a time [s]."""
        self._used_fix_s = max(self._used_fix_s, stamp_s)
        self._fixes.clear_refusals()
        self._refused.use(count)

    def _suspect(self, stamp_s: float, cause: str) -> None:
        """Take what speaks against the state at a time [s]; nothing does if it is empty."""
        if cause:
            self._suspected_s = stamp_s
            self._account.doubt(cause)

    def state(self) -> BaseState:
        state = self._witnesses.widened(super().state(), self._fixes.witness.moved2)
        if state.status != self._account.status:
            self._account.take(state.status, state.stamp_s, state.stamp_s - self._used_fix_s)
        return state

    def _status(self) -> str:
        if self._propagator.stamp_s - self._used_fix_s > self._streams.missing_after_s:
            return FALLBACK
        against_s = max(self._suspected_s, self._contradicted_s)
        trusted_s = against_s + self._settings.reacquire_after_s
        return SUSPECT if self._propagator.stamp_s < trusted_s else GLOBAL
