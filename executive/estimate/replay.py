"""Replay of a log to an estimator, which records states, latencies and counts."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from executive.clock import Clock, wall_s
from executive.estimate.drop import Drop
from executive.interfaces.estimation import Estimator
from executive.logs.log import Arrival
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.messages.status_change import reason_of


@dataclass(slots=True)
class Replay:
    """The result of one replay.

    Attributes:
        states: The state after every inertial sample of the main sensor, from the first one with
            a position.
        fixes: The reference: all fixes with a fixed RTK solution, also dropped ones; those of any
            kind of a log in which none has one.
        latency_us: Time from the arrival of each of those samples to the state [µs].
        counts: Observations fed by kind, and dropped ones.
        changes: Time [s], new status and reason at each change.
        wall_s: Duration of the replay [s].
        refused: Number of samples that the estimator refused, by stream and reason.
    """

    states: list[BaseState] = field(default_factory=list)
    fixes: list[GnssFix] = field(default_factory=list)
    latency_us: list[float] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    changes: list[tuple[float, str, str]] = field(default_factory=list)
    wall_s: float = 0.0
    refused: dict[str, int] = field(default_factory=dict)


class Replayer:
    """Hands arrivals to an estimator; lidar scans were replaced by increments before."""

    def __init__(self, estimator: Estimator, imu: str, drops: Sequence[Drop]) -> None:
        self._estimator = estimator
        self._imu = imu
        self._drops = drops
        self._replay = Replay()

    def run(self, arrivals: Sequence[Arrival], clock: Clock | None) -> Replay:
        """Feed all arrivals at full speed, or at the pace of a clock."""
        started_s = wall_s()
        for arrival in arrivals:
            while clock is not None and (early_s := arrival.arrival_s - clock.now_s()) > 0:
                # A clock counts from its last tick, so that one call may not be enough.
                clock.advance(early_s)
            self._take(arrival.observation)
        self._replay.wall_s = wall_s() - started_s
        if any(fix.is_rtk_fixed for fix in self._replay.fixes):
            self._replay.fixes = [fix for fix in self._replay.fixes if fix.is_rtk_fixed]
        self._replay.refused = dict(self._estimator.refused)
        return self._replay

    def _take(self, observation: Observation | LidarIncrement) -> None:
        replay = self._replay
        if isinstance(observation, GnssFix):
            replay.fixes.append(observation)
        if any(drop.takes(observation) for drop in self._drops):
            replay.counts["dropped"] += 1
            return
        if isinstance(observation, ImuSample):
            self._take_imu(observation)
            return
        replay.counts[type(observation).__name__] += 1
        self._estimator.add(observation)

    def _take_imu(self, sample: ImuSample) -> None:
        replay = self._replay
        replay.counts["ImuSample"] += 1
        if sample.frame != self._imu:
            self._estimator.add_imu(sample)
            return
        started_s = wall_s()
        self._estimator.add_imu(sample)
        state = self._estimator.state()
        took_us = 1e6 * (wall_s() - started_s)
        if not replay.changes or replay.changes[-1][1] != state.status:
            reason = reason_of(self._estimator.account(), state.status)
            replay.changes.append((sample.stamp_s, state.status, reason))
        if state.is_located and (not replay.states or state.stamp_s > replay.states[-1].stamp_s):
            replay.states.append(state)
            replay.latency_us.append(took_us)
