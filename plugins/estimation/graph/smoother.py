"""The two factor graphs and who leads: raw samples and measurements in, estimates out (Nubert 2022,
Sec. IV-C).
"""

from bisect import insort
from collections import Counter

import numpy as np
from executive_plugins.estimation.filters.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.gate.gnss_gate import Compared, GnssGate
from executive_plugins.estimation.gate.measurements import (
    Fix,
    Increment,
    Measurement,
    PendingMeasurement,
    Standstill,
)
from executive_plugins.estimation.graph.factors import (
    GAP_ACCELERATION_M_S2,
    GAP_RATE_RAD_S,
    between_factor,
    fix_factor,
    pose_factor,
)
from executive_plugins.estimation.graph.lidar_chain import LidarChain
from executive_plugins.estimation.graph.smoother_settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.graph.window import GraphWindow, UnsolvableError
from executive_plugins.estimation.inertial.measurement_models import antenna_residual
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.modes import Mode, Modes

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform

_SCAN_S = 0.3  # a fix is compared with the odometry of a scan at most so long before it
_FIX, _STANDING = "fix", "standing"
_BREAK_S = 0.3  # a gap of samples over which the graph is cut


class GraphSmoother:
    """Main graph with satellites and relative lidar; fallback graph with the lidar's poses as if
    they were global.

    The paper lets the second lead in an outage (Nubert 2022, Sec. IV-A4b, IV-C). Its anchor keeps
    the tilt and heading that were believed at the loss, and counts each pose as independent of the
    last: over ten simulated outages the worst error was a third larger than by the main graph
    alone. So that goes on to lead unless `fallback` says otherwise, and the covariance is its own
    in any case.
    """

    def __init__(
        self, settings: SmootherSettings, noise: InertialNoise, state: InertialState, P: Float
    ) -> None:
        self._settings = settings
        self._noise = noise
        self._samples = SampleBuffer()
        self._samples.append(state.sample)
        self._main = GraphWindow(noise, self._samples, state, P)
        self._fallback: GraphWindow | None = None
        self._last_good = (state, P)
        self._modes = Modes()
        self._gate = GnssGate(settings.gate)
        self._chain = LidarChain()
        self._anchor: Float | None = None  # T_map_chain of Eq. (10)
        self._waiting: list[PendingMeasurement] = []
        self._refused: Counter[str] = Counter()
        self._used_fix_s = state.stamp_s
        self._used_fix_way_m = 0.0
        self._standing = StandstillCheck(settings)

    @property
    def _leading(self) -> GraphWindow:
        return self._main if self._fallback is None else self._fallback

    def add_sample(self, sample: Inertial) -> None:
        """Take an inertial sample that is newer than all before."""
        before_s = self._samples.newest_s
        self._samples.append(sample)
        if sample.stamp_s - before_s > _BREAK_S:
            self._bridge(before_s, sample.stamp_s)

    def _bridge(self, before_s: float, after_s: float) -> None:
        """Begin anew after a gap of samples that is too long to integrate,
        at a guess and in doubt.
        """
        gap_s = after_s - before_s
        doubted = ErrorStateFilter(
            self._leading.state_at(after_s), self._leading.covariance, self._noise
        )
        doubted.doubt(
            0.5 * GAP_ACCELERATION_M_S2 * gap_s**2,
            GAP_ACCELERATION_M_S2 * gap_s,
            GAP_RATE_RAD_S * gap_s,
        )
        self._main = GraphWindow(self._noise, self._samples, doubted.state, doubted.covariance)
        self._last_good = (doubted.state, doubted.covariance)
        self._used_fix_s = max(self._used_fix_s, after_s)  # nothing could be used in the gap
        if self._fallback is not None:
            self._fallback = self._main.copy()
            self._anchor = None

    def add(self, measurement: Measurement) -> None:
        """Take a measurement, late or not; it is used in the next update that the samples have
        reached.
        """
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
        """Use what has arrived, solve, and forget what is older than the lag."""
        try:
            self._advance(self._samples.newest_s)
            self._solve()
        except UnsolvableError:
            self._rebuild()
        state, P = self._last_good = (
            self._leading.newest(),
            self._main.covariance,
        )  # the other's hides its anchor's
        estimate = Estimate(
            state, P, self._modes.current, tuple(self._modes.changes), dict(self._refused)
        )
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
        """Begin anew at the last good estimate: one graph, its window lost but not its
        knowledge.
        """
        self._refused["smoother: rebuilt"] += 1
        state, P = self._last_good
        self._main = GraphWindow(self._noise, self._samples, state, P)
        if self._fallback is not None:
            self._fallback = self._main.copy()
            self._anchor = None

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
        """Where the estimate knows better, what was said of standing lately was wrong as well."""
        state, P = self._predicted(standing.stamp_s)
        if self._standing.contradicts(standing, state, P):
            for window in self._windows():
                window.take_back(_STANDING, standing.stamp_s - self._settings.standing_doubt_s)
        if self._standing.is_believed(standing.stamp_s):
            for window in self._windows():
                node = window.node_at(standing.stamp_s)
                window.add(
                    _STANDING, standing.stamp_s, self._standing.factors(node, standing, state)
                )

    def _take_increment(self, increment: Increment) -> None:
        begun = self._chain.begun
        self._chain.add(increment)
        if self._chain.begun != begun:
            self._gate.forget_odometry()
            self._anchor = None
        if increment.from_s > self._main.oldest_s:
            nodes = self._main.node_at(increment.from_s), self._main.node_at(increment.stamp_s)
            factor = between_factor(*nodes, increment.T_from_to, increment.covariance)
            self._main.add("lidar", increment.stamp_s, [factor])
        if self._fallback is not None:
            self._add_pseudo_global(self._fallback, increment)

    def _add_pseudo_global(self, fallback: GraphWindow, increment: Increment) -> None:
        """Add T_map_chain · T_chain_imu (Eq. 10), the chain anchored where it was when the
        satellites were lost.
        """
        newest = self._chain.newest()
        if newest is None or increment.from_s <= fallback.oldest_s:
            return
        if self._anchor is None:
            before = fallback.state_at(increment.from_s)
            T_chain_before = newest[1] @ inverse(increment.T_from_to)
            self._anchor = pose(before.R_map_imu, before.p_map_imu) @ inverse(T_chain_before)
        T_map_imu = self._anchor @ newest[1]
        node = fallback.node_at(increment.stamp_s)
        fallback.add(
            "lidar",
            increment.stamp_s,
            [pose_factor(node, T_map_imu, self._pseudo_covariance(T_map_imu))],
        )

    def _pseudo_covariance(self, T_map_imu: Float) -> Float:
        settings, R = self._settings, T_map_imu[:3, :3]
        level, yaw = settings.fallback_level_std_rad**2, settings.fallback_yaw_std_rad**2
        P = settings.fallback_position_std_m**2 * np.eye(6)
        P[:3, :3] = R.T @ np.diag([level, level, yaw]) @ R
        return P

    def _take_fix(self, fix: Fix) -> None:
        compared = self._compared(fix)
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
        if "drifted" in refusal:  # those of the window drifted with it
            self._main.take_back(_FIX, fix.stamp_s - self._settings.gate.window_s)
        self._modes.change(fix.stamp_s, Mode.SUSPECT, f"{fix.antenna} {refusal}")
        if fix.stamp_s - self._used_fix_s > self._settings.fallback_after_s:
            self._fall_back(fix.stamp_s, f"{fix.antenna} {refusal}")

    def _use(self, fix: Fix) -> None:
        self._main.add(_FIX, fix.stamp_s, [fix_factor(self._main.node_at(fix.stamp_s), fix)])
        self._used_fix_s = max(self._used_fix_s, fix.stamp_s)
        self._used_fix_way_m = self._chain.way_m

    def _watch_silence(self, now_s: float) -> None:
        silent_s = now_s - self._used_fix_s
        if self._modes.current == Mode.GLOBAL and silent_s > self._settings.suspect_after_s:
            self._modes.change(now_s, Mode.SUSPECT, f"no fix for {silent_s:.1f} s")
        if self._modes.current == Mode.SUSPECT and silent_s > self._settings.fallback_after_s:
            self._fall_back(now_s, f"no good fix for {silent_s:.1f} s")

    def _fall_back(self, stamp_s: float, reason: str) -> None:
        """Do without satellites. If the fallback graph is to lead:
        at this point both are the same.
        """
        self._modes.change(stamp_s, Mode.FALLBACK, reason)
        self._gate.begin_recovery()
        if self._settings.fallback == "relative":
            return
        self._solve()  # without the fixes that were taken back
        self._fallback = self._main.copy()
        self._anchor = None
        newest = self._chain.newest()
        if newest is not None and self._main.oldest_s < newest[0] <= self._samples.newest_s:
            there = self._main.state_at(newest[0])
            self._anchor = pose(there.R_map_imu, there.p_map_imu) @ inverse(newest[1])

    def _recover(self, compared: Compared) -> None:
        fix = compared.fix
        self._refused[f"{fix.antenna}: not yet believed"] += 1
        if not self._gate.is_in_line(compared):
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

    def _return_to_main(self, first: Compared) -> None:
        """Let the main graph lead again; where it has drifted more than it knows, it begins anew in
        doubt.
        """
        leading, self._fallback = self._leading, None
        stamp_s = first.fix.stamp_s
        own = self._compared(first.fix)
        self._gate.forget_odometry()
        if own.distance2 < self._settings.gate.innovation:
            return
        state = leading.state_at(stamp_s)
        doubted = ErrorStateFilter(state, leading.covariance, self._noise)
        doubted.doubt(float(np.linalg.norm(first.residual)) + 0.1, 0.5, 0.1)
        self._main = GraphWindow(self._noise, self._samples, state, doubted.covariance)

    def _compared(self, fix: Fix) -> Compared:
        """Hold a fix against the leading estimate, and against the odometry alone."""
        window = self._leading
        state, P = self._predicted(fix.stamp_s)
        residual, H = antenna_residual(state, fix.arm_imu, fix.p_map_antenna)
        S = H @ P @ H.T + fix.covariance
        scan = self._chain.before(fix.stamp_s, _SCAN_S)
        if scan is None or scan[0] <= window.oldest_s:
            slack_m = 3 * float(np.sqrt(np.linalg.eigvalsh(H @ P @ H.T)[-1]))
            return Compared(
                fix, residual, S, fix.p_map_antenna - residual, np.eye(3), False, slack_m
            )
        T_chain_imu, R_map_chain = self._reckoned(state, *scan)
        return Compared(fix, residual, S, transform(T_chain_imu, fix.arm_imu), R_map_chain, True)

    def _predicted(self, stamp_s: float) -> tuple[InertialState, Float]:
        """Return what leads, at a time, and its covariance: the newest node's, grown by the time
        since.
        """
        window = self._leading
        state, ahead_s = window.state_at(stamp_s), stamp_s - window.newest_s
        if ahead_s <= 0:
            return state, window.covariance
        return state, ErrorStateFilter(state, window.covariance, self._noise).covariance_after(
            ahead_s
        )

    def _reckoned(
        self, state: InertialState, scan_s: float, T_chain_scan: Float
    ) -> tuple[Float, Float]:
        """Return the IMU by the lidar chain, carried on from the last scan, and the chain's
        attitude in the map.
        """
        at_scan = self._leading.state_at(scan_s)
        T_map_scan = pose(at_scan.R_map_imu, at_scan.p_map_imu)
        T_scan_imu = inverse(T_map_scan) @ pose(state.R_map_imu, state.p_map_imu)
        return T_chain_scan @ T_scan_imu, T_map_scan[:3, :3] @ T_chain_scan[:3, :3].T
