"""The factor graphs, from measurements to estimates (Nubert 2022, Sec. IV-C)."""

from bisect import insort
from collections import Counter
from dataclasses import replace

import numpy as np
from executive_plugins.estimation.factors import GAP_ACCELERATION_M_S2, GAP_RATE_RAD_S
from executive_plugins.estimation.gate.gnss_gate import Compared, GnssGate
from executive_plugins.estimation.gate.measurements import (
    Fix,
    Increment,
    Measurement,
    PendingMeasurement,
    Standstill,
)
from executive_plugins.estimation.graph.chain_anchor import ChainAnchor
from executive_plugins.estimation.graph.drift_dispute import DriftDispute
from executive_plugins.estimation.graph.fix_comparison import compared, predicted
from executive_plugins.estimation.graph.fix_watch import FixWatch
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.lidar_chain import LidarChain
from executive_plugins.estimation.graph.odometry_use import OdometryUse
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.graph.window import GraphWindow, UnsolvableError
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.modes import Mode, Modes

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
        self._odometry = OdometryUse(settings, noise, self._window_of(first))
        self._fallback: GraphWindow | None = None
        self._last_good = first
        self._modes = Modes()
        self._gate = GnssGate(settings.gate)
        self._fixes = FixWatch(settings, first.state.stamp_s)
        self._chain = LidarChain()
        self._anchor = ChainAnchor(settings)
        self._waiting: list[PendingMeasurement] = []
        self._refused: Counter[str] = Counter()
        self._standing = StandstillCheck(settings)
        self._dispute = DriftDispute(self._odometry, self._gate, settings.gate.unlock_after_s)

    @property
    def _main(self) -> GraphWindow:
        return self._odometry.pair.main

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
        state, P = self._leading.state_at(after_s), self._leading.covariance
        propagated = replace(self._last_good, state=state, covariance=P)
        self._begin_again(
            propagated.widened(
                self._noise,
                0.5 * GAP_ACCELERATION_M_S2 * gap_s**2,
                GAP_ACCELERATION_M_S2 * gap_s,
                GAP_RATE_RAD_S * gap_s,
            )
        )
        self._fixes.used_s = max(self._fixes.used_s, after_s)  # none could be used during the gap

    def _begin_again(self, first: GraphEstimate) -> None:
        """Start new graphs at an estimate; the measurements in the window are lost."""
        self._last_good = first
        self._odometry.begin_with(self._window_of(first))
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
            if self._odometry.conclude():
                self._gate.forget_odometry()
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
        both = self._odometry.pair.both
        return both if self._fallback is None else (*both, self._fallback)

    def _solve(self) -> None:
        for window in self._windows():
            window.solve()
            window.forget_before(window.newest_s - self._settings.lag_s)
        self._samples.forget_before(min(window.oldest_s for window in self._windows()))

    def _rebuild(self) -> None:
        """Start new graphs at the last good estimate."""
        self._refused["smoother: rebuilt"] += 1
        self._begin_again(self._last_good)

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
        """Use a standstill, unless the estimate contradicts it."""
        state, P = predicted(self._leading, standing.stamp_s, self._noise)
        self._standing.take(standing, state, P, self._windows())

    def _take_increment(self, increment: Increment) -> None:
        since_fix_s = self._fixes.drifting_s(increment.stamp_s)
        if not self._odometry.add(increment, since_fix_s, self._fixes_hold()):
            self._refused["odometry: outlier"] += 1
            return  # the next increment begins a new chain
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
        return not (self._modes.is_fallen_back or self._fixes.contradicts)

    def _take_fix(self, fix: Fix) -> None:
        compared = self._compared(fix)
        self._fixes.add(compared)
        if self._modes.is_fallen_back:
            self._recover(compared)
            return
        refusal = self._gate.refusal(compared)
        if "drifted" in refusal:
            refusal = self._dispute.verdict(fix.stamp_s, refusal)
        elif self._odometry.takes_fix(fix, bool(refusal), self._fixes.period_s):
            self._gate.forget_odometry()
            refusal = ""
        elif not refusal and self._fixes.contradicts:
            self._dispute.leave_contradicted()
        if refusal:
            self._refuse(fix, refusal)
            return
        self._use(fix)
        if self._dispute.is_open(fix.stamp_s):
            self._modes.change(fix.stamp_s, Mode.SUSPECT, f"{fix.antenna} {self._dispute.reason}")
        else:
            self._modes.change(fix.stamp_s, Mode.GLOBAL, f"{fix.antenna} agrees")

    def _refuse(self, fix: Fix, refusal: str) -> None:
        self._refused[f"{fix.antenna}: outlier"] += 1
        if "drifted" in refusal:  # the other fixes of the window have drifted as well
            self._odometry.pair.take_back_fixes(fix.stamp_s - self._settings.gate.window_s)
        self._modes.change(fix.stamp_s, Mode.SUSPECT, f"{fix.antenna} {refusal}")
        if fix.stamp_s - self._fixes.used_s > self._fixes.fallback_after_s:
            self._fall_back(fix.stamp_s, f"{fix.antenna} {refusal}")

    def _use(self, fix: Fix) -> None:
        self._odometry.pair.add_fix(fix)
        self._fixes.use(fix.stamp_s, self._chain.way_m)

    def _watch_silence(self, now_s: float) -> None:
        silent_s = now_s - self._fixes.used_s
        if self._modes.current == Mode.GLOBAL and silent_s > self._fixes.suspect_after_s:
            self._modes.change(now_s, Mode.SUSPECT, f"no fix for {silent_s:.1f} s")
        if self._modes.current == Mode.SUSPECT and silent_s > self._fixes.fallback_after_s:
            self._fall_back(now_s, f"no good fix for {silent_s:.1f} s")

    def _fall_back(self, stamp_s: float, reason: str) -> None:
        """Continue without satellites, and start the fallback graph if it shall give the estimate.

        The fallback graph starts as a copy of the main graph.
        """
        self._modes.change(stamp_s, Mode.FALLBACK, reason)
        self._gate.begin_recovery()
        self._odometry.rely()
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
        if not self._gate.is_in_line(compared, self._fixes.missing_after_s):
            self._modes.change(
                fix.stamp_s, Mode.FALLBACK, f"{fix.antenna} disagrees with those before it"
            )
            return
        self._modes.change(fix.stamp_s, Mode.RECOVERING, f"{fix.antenna} is back")
        reason = self._gate.verdict(self._chain.way_m - self._fixes.used_way_m, self._fixes.used_s)
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
        chain = self._chain if self._dispute.compares() else None
        return compared(fix, self._leading, chain, self._noise)

    def _return_to_main(self, agreed: Compared) -> None:
        """Use the main graph again after an outage.

        If it has drifted by more than its covariance allows, it is started again at the leading
        estimate with an inflated covariance.
        """
        leading, self._fallback = self._leading, None
        by_main = self._compared(agreed.fix)
        self._gate.forget_odometry()
        if by_main.distance2 < self._settings.gate.innovation:
            return
        state = leading.state_at(agreed.fix.stamp_s)
        own = GraphEstimate(state, leading.covariance, self._main.clock)
        off_m = float(np.linalg.norm(agreed.residual))
        first = own.widened(self._noise, off_m + 0.1, 0.5, 0.1)
        self._odometry.begin_with(self._window_of(first))
