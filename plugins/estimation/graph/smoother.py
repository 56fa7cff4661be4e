"""The two factor graphs, from measurements to estimates (Nubert 2022, Sec. IV-C)."""

from bisect import insort
from collections import Counter
from dataclasses import replace

import numpy as np
from executive_plugins.estimation.factors import (
    GAP_ACCELERATION_M_S2,
    GAP_RATE_RAD_S,
    between_factor,
)
from executive_plugins.estimation.gate.gnss_gate import Compared, GnssGate
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.measurements import (
    Fix,
    Increment,
    Measurement,
    PendingMeasurement,
    Standstill,
)
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.graph.chain_anchor import ChainAnchor
from executive_plugins.estimation.graph.fix_comparison import compared, predicted
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.increment_check import IncrementCheck
from executive_plugins.estimation.graph.lidar_chain import LidarChain
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.graph.window import GraphWindow, UnsolvableError
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.modes import Mode, Modes

from executive.arrays import Float

_FIX, _STANDING = "fix", "standing"
_BREAK_S = 0.3  # a longer gap of samples is not integrated


class GraphSmoother:
    """The main graph with fixes and relative lidar poses, and a fallback graph with global ones.

    In the paper the fallback graph leads in an outage (Nubert 2022, Sec. IV-A4b, IV-C). It keeps
    tilt and heading from the beginning of the outage, and takes each lidar pose as independent of
    the last. Over ten simulated outages its worst error was a third larger than that of the main
    graph alone. The main graph therefore leads throughout unless the setting `fallback` says
    otherwise, and the covariance is always that of the main graph.
    """

    def __init__(
        self, settings: SmootherSettings, noise: InertialNoise, first: GraphEstimate
    ) -> None:
        self._settings = settings
        self._noise = noise
        self._samples = SampleBuffer()
        self._samples.append(first.state.sample)
        self._main = self._window_of(first)
        self._fallback: GraphWindow | None = None
        self._last_good = first
        self._modes = Modes()
        self._gate = GnssGate(settings.gate)
        self._increments = IncrementCheck(noise, settings.increment_gate)
        self._fix_alarm, self._fix_period = InnovationAlarm(3), StreamPeriod()
        self._chain = LidarChain()
        self._anchor = ChainAnchor(settings)
        self._waiting: list[PendingMeasurement] = []
        self._refused: Counter[str] = Counter()
        self._used_fix_s = first.state.stamp_s
        self._used_fix_way_m = 0.0
        self._standing = StandstillCheck(settings)

    @property
    def _leading(self) -> GraphWindow:
        return self._main if self._fallback is None else self._fallback

    def add_sample(self, sample: Inertial) -> None:
        """Add an inertial sample that is newer than all before."""
        before_s = self._samples.newest_s
        self._samples.append(sample)
        if sample.stamp_s - before_s > _BREAK_S:
            self._bridge(before_s, sample.stamp_s)

    def _bridge(self, before_s: float, after_s: float) -> None:
        """Start a new graph after a gap in the samples that is too long to integrate.

        Its first state is the propagated one, with its covariance inflated.
        """
        gap_s = after_s - before_s
        widened = ErrorStateFilter(
            self._leading.state_at(after_s), self._leading.covariance, self._noise
        )
        widened.inflate(
            0.5 * GAP_ACCELERATION_M_S2 * gap_s**2,
            GAP_ACCELERATION_M_S2 * gap_s,
            GAP_RATE_RAD_S * gap_s,
        )
        self._begin_again(widened.state, widened.covariance)
        self._used_fix_s = max(self._used_fix_s, after_s)  # no fix could be used during the gap

    def _begin_again(self, state: InertialState, P: Float) -> None:
        """Start new graphs at a state; the measurements in the window are lost."""
        self._last_good = replace(self._last_good, state=state, covariance=P)
        self._main = self._window_of(self._last_good)
        if self._fallback is not None:
            self._fallback = self._main.copy()
            self._anchor.clear()

    def _window_of(self, first: GraphEstimate) -> GraphWindow:
        return GraphWindow(self._noise, self._samples, first.state, first.covariance, first.clock)

    def add(self, measurement: Measurement) -> None:
        """Add a measurement, late or not; the next update that the samples have reached uses it."""
        insort(self._waiting, PendingMeasurement(measurement.stamp_s, measurement))

    @property
    def is_waiting(self) -> bool:
        """Whether there is a measurement that has not been used."""
        return bool(self._waiting)

    @property
    def is_due(self) -> bool:
        """Whether an update would bring anything new."""
        newest_s = self._samples.newest_s
        if self._waiting and self._waiting[0].stamp_s <= newest_s:
            return True
        return newest_s - self._leading.newest_s >= self._settings.node_after_s

    def update(self) -> Estimate:
        """Use the new measurements, solve, and marginalise what is older than the lag."""
        try:
            self._advance(self._samples.newest_s)
            self._solve()
        except UnsolvableError:
            self._rebuild()
        # The fallback graph's own covariance does not include the error of its anchor.
        state, P, clock = self._leading.newest(), self._main.covariance, self._main.clock
        found = self._last_good = replace(self._last_good, state=state, covariance=P, clock=clock)
        changes = tuple(self._modes.changes)
        estimate = Estimate(*found.reported(), self._modes.current, changes, dict(self._refused))
        self._modes.changes.clear()
        self._refused.clear()
        return estimate

    def _advance(self, now_s: float) -> None:
        while self._waiting and self._waiting[0].stamp_s <= now_s:
            self._take(self._waiting.pop(0).measurement)
        self._watch_silence(now_s)
        if now_s - self._leading.newest_s >= self._settings.node_after_s:
            for window in self._windows():
                window.node_at(now_s)

    def _windows(self) -> tuple[GraphWindow, ...]:
        return (self._main,) if self._fallback is None else (self._main, self._fallback)

    def _solve(self) -> None:
        for window in self._windows():
            window.solve()
            window.forget_before(window.newest_s - self._settings.lag_s)
        self._samples.forget_before(min(window.oldest_s for window in self._windows()))

    def _rebuild(self) -> None:
        """Start new graphs at the last good estimate."""
        self._refused["smoother: rebuilt"] += 1
        self._begin_again(self._last_good.state, self._last_good.covariance)

    def _take(self, measurement: Measurement) -> None:
        if measurement.stamp_s <= self._leading.oldest_s:
            name = (
                measurement.antenna
                if isinstance(measurement, Fix)
                else type(measurement).__name__.lower()
            )
            self._refused[f"{name}: too late"] += 1
        elif isinstance(measurement, Fix):
            self._take_fix(measurement)
        elif isinstance(measurement, Increment):
            self._take_increment(measurement)
        else:
            self._take_standing(measurement)

    def _take_standing(self, standing: Standstill) -> None:
        """Use a standstill, unless the estimate contradicts it.

        After a contradiction, the standstills shortly before it are removed as well.
        """
        state, P = predicted(self._leading, standing.stamp_s, self._noise)
        if self._standing.contradicts(standing, state, P):
            for window in self._windows():
                window.take_back(_STANDING, standing.stamp_s - self._settings.standing_doubt_s)
        if self._standing.is_accepted(standing.stamp_s):
            for window in self._windows():
                node = window.node_at(standing.stamp_s)
                window.add(
                    _STANDING, standing.stamp_s, self._standing.factors(node, standing, state)
                )

    def _take_increment(self, increment: Increment) -> None:
        if increment.from_s > self._main.oldest_s:
            admitted = self._increments.admitted(increment, self._main, self._fixes_hold())
            if admitted is None:
                self._refused["odometry: outlier"] += 1
                return  # the next increment begins a new chain
            nodes = self._main.node_at(increment.from_s), self._main.node_at(increment.stamp_s)
            factor = between_factor(*nodes, increment.T_from_to, admitted.covariance)
            self._main.add("lidar", increment.stamp_s, [factor])
        begun = self._chain.begun
        self._chain.add(increment)
        if self._chain.begun != begun:
            self._gate.forget_odometry()
            self._anchor.clear()
        newest = self._chain.newest()
        if self._fallback is not None and newest is not None:
            self._anchor.add_pose(self._fallback, increment, newest[1])

    def _fixes_hold(self) -> bool:
        """Return whether the estimate is held by fixes that agree with it.

        Fixes that drift contradict odometry as well; they contradict the estimate first.
        """
        return not (self._modes.is_fallen_back or self._fix_alarm.is_raised)

    def _take_fix(self, fix: Fix) -> None:
        compared = self._compared(fix)
        self._fix_period.add(fix.stamp_s)
        gate, period_s = self._settings.gate.innovation, self._fix_period.period_s
        self._fix_alarm.add(compared.residual, compared.covariance, gate, period_s)
        if self._modes.is_fallen_back:
            self._recover(compared)
            return
        refusal = self._gate.refusal(compared)
        if refusal:
            self._refuse(fix, refusal)
            return
        self._use(fix)
        self._modes.change(fix.stamp_s, Mode.GLOBAL, f"{fix.antenna} agrees")

    def _refuse(self, fix: Fix, refusal: str) -> None:
        self._refused[f"{fix.antenna}: outlier"] += 1
        if "drifted" in refusal:  # the other fixes of the window have drifted as well
            self._main.take_back(_FIX, fix.stamp_s - self._settings.gate.window_s)
        self._modes.change(fix.stamp_s, Mode.SUSPECT, f"{fix.antenna} {refusal}")
        if fix.stamp_s - self._used_fix_s > self._fallback_after_s:
            self._fall_back(fix.stamp_s, f"{fix.antenna} {refusal}")

    def _use(self, fix: Fix) -> None:
        self._main.add(_FIX, fix.stamp_s, [self._main.factor_of(fix)])
        self._used_fix_s = max(self._used_fix_s, fix.stamp_s)
        self._used_fix_way_m = self._chain.way_m

    @property
    def _fallback_after_s(self) -> float:
        """Time without a used fix until FALLBACK: fixes that come seldom are not missing."""
        return max(self._settings.fallback_after_s, self._fix_period.missing_after_s)

    def _watch_silence(self, now_s: float) -> None:
        silent_s = now_s - self._used_fix_s
        suspect_after_s = max(self._settings.suspect_after_s, self._fix_period.overdue_after_s)
        if self._modes.current == Mode.GLOBAL and silent_s > suspect_after_s:
            self._modes.change(now_s, Mode.SUSPECT, f"no fix for {silent_s:.1f} s")
        if self._modes.current == Mode.SUSPECT and silent_s > self._fallback_after_s:
            self._fall_back(now_s, f"no good fix for {silent_s:.1f} s")

    def _fall_back(self, stamp_s: float, reason: str) -> None:
        """Continue without satellites, and start the fallback graph if it shall give the estimate.

        The fallback graph starts as a copy of the main graph.
        """
        self._modes.change(stamp_s, Mode.FALLBACK, reason)
        self._gate.begin_recovery()
        self._increments.acquit()
        if self._settings.fallback == "relative":
            return
        self._solve()  # without the fixes that were removed
        self._fallback = self._main.copy()
        self._anchor.clear()
        newest = self._chain.newest()
        if newest is not None and self._main.oldest_s < newest[0] <= self._samples.newest_s:
            self._anchor.place(self._main, *newest)

    def _recover(self, compared: Compared) -> None:
        fix = compared.fix
        self._refused[f"{fix.antenna}: during recovery"] += 1
        if not self._gate.is_in_line(compared, self._fix_period.missing_after_s):
            self._modes.change(
                fix.stamp_s, Mode.FALLBACK, f"{fix.antenna} disagrees with those before it"
            )
            return
        self._modes.change(fix.stamp_s, Mode.RECOVERING, f"{fix.antenna} is back")
        reason = self._gate.verdict(self._chain.way_m - self._used_fix_way_m, self._used_fix_s)
        if not reason:
            return
        agreed = self._gate.agreed(self._leading.oldest_s + 0.1)
        if not agreed:
            return
        self._return_to_main(agreed[0])
        for good in agreed:
            self._use(good.fix)
        self._modes.change(fix.stamp_s, Mode.GLOBAL, reason)

    def _compared(self, fix: Fix) -> Compared:
        return compared(fix, self._leading, self._chain, self._noise)

    def _return_to_main(self, first: Compared) -> None:
        """Use the main graph again after an outage.

        If it has drifted by more than its covariance allows, it is started again at the leading
        estimate with an inflated covariance.
        """
        leading, self._fallback = self._leading, None
        stamp_s = first.fix.stamp_s
        own = self._compared(first.fix)
        self._gate.forget_odometry()
        if own.distance2 < self._settings.gate.innovation:
            return
        state = leading.state_at(stamp_s)
        widened = ErrorStateFilter(state, leading.covariance, self._noise)
        widened.inflate(float(np.linalg.norm(first.residual)) + 0.1, 0.5, 0.1)
        self._main = self._window_of(GraphEstimate(state, widened.covariance, self._main.clock))
