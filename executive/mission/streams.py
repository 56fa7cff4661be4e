"""Where observations go: in order of stamps to the estimator, odometry, mapper and monitors."""

from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from executive.clock import wall_s
from executive.interfaces.estimation import Estimator
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.odometry import LidarOdometry
from executive.interfaces.plugin import Plugin
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.observation import Observation
from executive.messages.status_change import StatusChange, reason_of
from executive.messages.verdict import Verdict
from executive.mission.assembly import each_plugin
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.notes import loop_in_verb
from executive.mission.jobs.tick_call import asked
from executive.mission.map_feed import MapFeed
from executive.mission.record.samples import Samples
from executive.mission.tick_times import TickTimes, step_of

_HISTORY_S = 1.0  # a scan pair spans at most two revolutions of 0.1 s, plus the sensors' latency


class StreamListener(ABC):
    """Takes what the streams give rise to."""

    @abstractmethod
    def take_verdict(self, verdict: Verdict) -> None:
        """Take a verdict of a monitor."""

    @abstractmethod
    def take_status(self, change: StatusChange) -> None:
        """Take a change of the estimator's status."""

    @abstractmethod
    def take_error(self, capability: str, plugin: Plugin, error: Exception) -> None:
        """Take an error of a stream plugin that the mission can do without, or raise it again."""

    @abstractmethod
    def take_unknown(self, kind: str) -> None:
        """Take the first observation of a type that no plugin takes."""


class StreamGuard(ABC):
    """Decides which observations reach the plugins, and whether scans may be fused."""

    @abstractmethod
    def refuses(self, observation: object) -> bool:
        """Return whether an observation cannot be true; it then goes to no plugin."""

    @abstractmethod
    def may_fuse(self, stamp_s: float, behind: int = 0) -> bool:
        """Return whether a scan pair may be fused.

        Args:
            stamp_s: Its stamp [s], at which the cabin's pose must be known well enough.
            behind: Number of earlier pairs that are not fused yet.
        """


class Streams:
    """Feeds the stream plugins and keeps the newest values for snapshots."""

    def __init__(
        self,
        plugins: Mapping[str, Any],
        lidars: Sequence[str],
        listener: StreamListener,
        guard: "StreamGuard | None" = None,
        jobs: Jobs | None = None,
    ) -> None:
        self._estimator: Estimator = plugins["estimation"]
        self._odometry: LidarOdometry | None = plugins.get("odometry")
        self._mapper: Mapper | None = plugins.get("mapping")
        self.monitors: list[Monitor] = list(plugins.get("monitoring", ()))
        self._observers = _observers(plugins)
        self._lidars = tuple(lidars)
        self._listener = listener
        self._times = TickTimes() if jobs is None else jobs.times
        self._feed: MapFeed | None = None
        mapper = self._mapper
        if jobs is not None and mapper and jobs.computes_beside(mapper, "add_scan_pair"):
            self._feed = MapFeed(mapper, jobs)
        self._guard = guard
        self._status = "INITIALISING"
        self._told = 0  # number of the estimator's status changes that have been handed on
        self._history: deque[tuple[float, BaseState, JointSample]] = deque()
        self._scans: dict[str, LidarScan] = {}
        self._handlers: Mapping[type, Callable[[Any], None]] = {
            ImuSample: self._take_imu,
            GnssFix: lambda fix: self._asked(self._estimator.add_gnss, fix),
            JointSample: self._take_joints,
            LidarScan: self._take_scan,
        }
        self.joints: JointSample | None = None
        self.scan_pairs = 0
        self.arrived_scans: list[LidarScan] = []  # of this tick
        self.ignored: Counter[str] = Counter()  # observations by type that no plugin takes
        self.durations_ms: dict[str, Samples[float]] = {}

    def process(self, observations: Sequence[Observation]) -> None:
        """Take all observations of one tick."""
        self.arrived_scans.clear()
        if self._feed is not None and self._feed.behind:
            self._count_fused(self._feed.take_fused)
        for observation in observations:
            if self._guard is not None and self._guard.refuses(observation):
                continue
            handler = self._handlers.get(type(observation))
            if handler is not None:
                handler(observation)
            if not self._observe(observation) and handler is None:
                self._ignore(observation)
        self._hand_on_status()

    def settle(self) -> None:
        """Wait until the map holds every scan pair that has come.

        Raises:
            Exception: What the mapper raises, where the mission cannot do without it.
        """
        if self._feed is not None:
            self._count_fused(self._feed.settle)

    def state(self) -> BaseState:
        """Return the newest state estimate.

        Raises:
            WrongAnswerError: If the estimator returns something else, or a NaN.
        """
        state: BaseState = asked(self._estimator.state)
        return state

    def status_reason(self, status: str) -> str:
        """Return why the estimator has a status, by the newest entry of its account."""
        return reason_of(self._estimator.account(), status)

    def recent_states(self) -> Sequence[BaseState]:
        """Return the states of the last second, in order of their stamps."""
        return [state for _, state, _ in self._history]

    def _asked(self, verb: Callable[..., Any], *args: object) -> Any:
        """Call a verb of a stream plugin within the tick."""
        with self._times.spent(step_of(verb)):
            return asked(verb, *args)

    def _observe(self, observation: object) -> bool:
        """Hand an observation to the plugins that ask for its type; return whether one does."""
        asking = [(c, p) for c, p in self._observers if isinstance(observation, p.takes)]
        for capability, plugin in asking:
            try:
                with self._times.spent(f"{capability}.take"), loop_in_verb(plugin, "take"):
                    plugin.take(observation)
            except Exception as error:  # the listener decides what it means
                self._listener.take_error(capability, plugin, error)
                self._observers.remove((capability, plugin))
        return bool(asking)

    def _ignore(self, observation: object) -> None:
        kind = type(observation).__name__
        self.ignored[kind] += 1
        if self.ignored[kind] == 1:
            self._listener.take_unknown(kind)

    def _hand_on_status(self) -> None:
        """Hand on each change of the estimator's status once, with its reason if there is one."""
        state: BaseState = self._asked(self._estimator.state)
        account = self._estimator.account()
        for change in account[self._told :]:
            self._listener.take_status(change)
            self._status = change.after
        if state.status != self._status:
            self._listener.take_status(StatusChange(state.stamp_s, self._status, state.status, ""))
        self._told, self._status = len(account), state.status

    def _take_imu(self, sample: ImuSample) -> None:
        self._asked(self._estimator.add_imu, sample)
        if self._odometry is not None:
            self._with_odometry(self._odometry.add_imu, sample)

    def _take_joints(self, sample: JointSample) -> None:
        self._asked(self._estimator.add_joints, sample)
        if self._odometry is not None:
            self._with_odometry(self._odometry.add_joints, sample)
        self.joints = sample
        for monitor in tuple(self.monitors):
            self._watch(monitor, sample)
        state: BaseState = self._asked(self._estimator.state)
        if state.is_ready and (not self._history or state.stamp_s > self._history[-1][0]):
            self._history.append((state.stamp_s, state, sample))
            while self._history[0][0] < state.stamp_s - _HISTORY_S:
                self._history.popleft()

    def _watch(self, monitor: Monitor, sample: JointSample) -> None:
        try:
            verdict = self._asked(monitor.update, sample)
        except Exception as error:  # the listener decides what it means
            self._listener.take_error("monitoring", monitor, error)
            self.monitors.remove(monitor)
            return
        if verdict is not None:
            self._listener.take_verdict(verdict)

    def _take_scan(self, scan: LidarScan) -> None:
        if self._odometry is not None:
            increment = self._with_odometry(self._odometry.add_scan, scan)
            if increment is not None:
                self._asked(self._estimator.add_odometry, increment)
        self._scans[scan.frame] = scan
        self.arrived_scans.append(scan)
        if self._mapper is not None and self._history and len(self._scans) == len(self._lidars):
            self._map(self._mapper)

    def _with_odometry(self, verb: Callable[[Any], Any], observation: Observation) -> Any:
        try:
            return self._asked(verb, observation)
        except Exception as error:  # the listener decides what it means
            if self._odometry is not None:
                self._listener.take_error("odometry", self._odometry, error)
            self._odometry = None
            return None

    def _map(self, mapper: Mapper) -> None:
        newest_s = max(scan.stamp_s for scan in self._scans.values())
        behind = 0 if self._feed is None else self._feed.behind
        if self._guard is not None and not self._guard.may_fuse(newest_s, behind):
            self._scans.clear()
            return
        if self._feed is not None:
            self._feed.send([self._scans[name] for name in self._lidars], self._motion())
            self._scans.clear()
            return
        started_s = wall_s()
        try:
            pair = [self._scans[name] for name in self._lidars]
            self._asked(mapper.add_scan_pair, pair, self._motion())
        except Exception as error:  # the listener decides what it means
            self._listener.take_error("mapping", mapper, error)
            self._mapper = None
            return
        self.durations_ms.setdefault("mapping.add_scan_pair", Samples()).append(
            1e3 * (wall_s() - started_s)
        )
        self.scan_pairs += 1
        self._scans.clear()

    def _count_fused(self, fused: Callable[[], int]) -> None:
        """Count the pairs that a thread has fused; after an error no more are sent."""
        mapper = self._mapper
        if mapper is None:
            return
        try:
            self.scan_pairs += fused()
        except Exception as error:  # the listener decides what it means
            self._mapper = self._feed = None
            self._listener.take_error("mapping", mapper, error)

    def _motion(self) -> Motion:
        stamps, states, samples = zip(*self._history, strict=True)
        return Motion(
            stamps_s=np.array(stamps),
            T_map_cabin=np.stack([state.T_map_cabin for state in states]),
            joint_names=samples[0].names,
            joint_position=np.stack([sample.position for sample in samples]),
            covariance=states[-1].covariance,
        )


def _observers(plugins: Mapping[str, Any]) -> list[tuple[str, Plugin]]:
    """Return capability and plugin of those that ask for observations by type."""
    return [(c, plugin) for c, plugin in each_plugin(plugins) if getattr(plugin, "takes", ())]
