"""Where observations go: in order of stamps to the estimator, the odometry, the mapper and the
monitors.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from executive.clock import wall_s
from executive.interfaces.estimation import Estimator
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.odometry import LidarOdometry
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.observation import Observation
from executive.messages.status_change import StatusChange
from executive.messages.verdict import Verdict

_HISTORY_S = 1.0  # a scan pair spans at most two revolutions of 0.1 s, plus the sensors' latency


class Streams:
    """Feeds the stream plugins and keeps the newest values for snapshots."""

    def __init__(
        self,
        plugins: Mapping[str, Any],
        lidars: Sequence[str],
        on_verdict: Callable[[Verdict], None],
        on_status: Callable[[StatusChange], None] = lambda change: None,
    ) -> None:
        self._estimator: Estimator = plugins["estimation"]
        self._odometry: LidarOdometry | None = plugins.get("odometry")
        self._mapper: Mapper | None = plugins.get("mapping")
        self._monitors: Sequence[Monitor] = plugins.get("monitoring", ())
        self._lidars = tuple(lidars)
        self._on_verdict = on_verdict
        self._on_status = on_status
        self._status = "INITIALISING"
        self._told = 0  # changes of the estimator's account that have been handed on
        self._history: deque[tuple[float, BaseState, JointSample]] = deque()
        self._scans: dict[str, LidarScan] = {}
        self.joints: JointSample | None = None
        self.scan_pairs = 0
        self.durations_ms: dict[str, list[float]] = {}

    def process(self, observations: Sequence[Observation]) -> None:
        """Take all observations of one tick."""
        handlers: Mapping[type, Callable[[Any], None]] = {
            ImuSample: self._take_imu,
            GnssFix: self._estimator.add_gnss,
            JointSample: self._take_joints,
            LidarScan: self._take_scan,
        }
        for observation in observations:
            handlers[type(observation)](observation)
        self._tell_status()

    def _tell_status(self) -> None:
        """Hand on each change of the estimator's status once: with its reason, or as it shows where
        none is given.
        """
        account = self._estimator.account()
        state = self._estimator.state()
        for change in account[self._told :]:
            self._on_status(change)
            self._status = change.after
        if state.status != self._status:
            self._on_status(StatusChange(state.stamp_s, self._status, state.status, ""))
        self._told, self._status = len(account), state.status

    def state(self) -> BaseState:
        """Return the newest state estimate."""
        return self._estimator.state()

    def _take_imu(self, sample: ImuSample) -> None:
        self._estimator.add_imu(sample)
        if self._odometry is not None:
            self._odometry.add_imu(sample)

    def _take_joints(self, sample: JointSample) -> None:
        self._estimator.add_joints(sample)
        if self._odometry is not None:
            self._odometry.add_joints(sample)
        self.joints = sample
        for monitor in self._monitors:
            verdict = monitor.update(sample)
            if verdict is not None:
                self._on_verdict(verdict)
        state = self._estimator.state()
        if state.is_ready and (not self._history or state.stamp_s > self._history[-1][0]):
            self._history.append((state.stamp_s, state, sample))
            while self._history[0][0] < state.stamp_s - _HISTORY_S:
                self._history.popleft()

    def _take_scan(self, scan: LidarScan) -> None:
        if self._odometry is not None:
            increment = self._odometry.add_scan(scan)
            if increment is not None:
                self._estimator.add_odometry(increment)
        self._scans[scan.frame] = scan
        if self._mapper is not None and self._history and len(self._scans) == len(self._lidars):
            started_s = wall_s()
            self._mapper.add_scan_pair([self._scans[name] for name in self._lidars], self._motion())
            self.durations_ms.setdefault("mapping.add_scan_pair", []).append(
                1e3 * (wall_s() - started_s)
            )
            self.scan_pairs += 1
            self._scans.clear()

    def _motion(self) -> Motion:
        stamps, states, samples = zip(*self._history, strict=True)
        return Motion(
            stamps_s=np.array(stamps),
            T_map_cabin=np.stack([state.T_map_cabin for state in states]),
            joint_names=samples[0].names,
            joint_position=np.stack([sample.position for sample in samples]),
            covariance=states[-1].covariance,
        )
