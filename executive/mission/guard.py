"""The guard of a mission: faults on purpose, the gate of the streams, watched conditions."""

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from executive import registry
from executive.arrays import Float
from executive.clock import Clock
from executive.events.event import Event
from executive.events.mission import Fault as FaultRecord
from executive.events.watch import ObservationRefused, SamplesMissing, ScansNotFused
from executive.faults.description import Fault
from executive.faults.tap import tap
from executive.interfaces.robot import Robot
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.mission.record.samples import Samples
from executive.mission.streams import StreamGuard, Streams
from executive.watch.ages import Ages
from executive.watch.antenna_check import AntennaCheck
from executive.watch.estimate_watch import estimate_trouble, stale
from executive.watch.gate import Gate
from executive.watch.motion import MotionWatch
from executive.watch.rules import ESTIMATE, EstimateRule, Watched
from executive.watch.watch import Decision, Watch

# Pairs that may wait to be fused: five seconds of a lidar of 10 Hz, some 70 MB of returns.
MOST_BEHIND = 50
_JUDGED = 3600  # states in memory, an hour of one a second; later every second, every fourth


@dataclass(frozen=True, slots=True)
class GuardSettings:
    """What a mission's file says of faults and of what is watched."""

    faults: Sequence[Fault] = ()
    watch: Watched | None = None
    has_judge: bool = False  # something can judge what the robot has done, in another process


class Guard(StreamGuard):
    """Refuses observations that cannot be true, and asks for a hold or a stop."""

    def __init__(
        self,
        settings: GuardSettings,
        machine: Machine,
        plugins: Mapping[str, Any],
        clock: Clock,
        record: Callable[[Event], None],
    ) -> None:
        self._machine, self._clock, self._record = machine, clock, record
        self._robot: Robot = plugins["robot"]
        self._estimator: Any = plugins["estimation"]
        self._streams: Streams | None = None
        antennas = AntennaCheck(machine, self._states, self._datum)
        self._gate = Gate(machine, antennas, is_ideal=self._robot.is_ideal)
        self._ages = Ages(machine, self._robot.lacks, clock.machine_s())
        self._motion = MotionWatch(
            machine, self._T_map_base, has_efforts="efforts" not in self._robot.lacks
        )
        self._watch = Watch(machine, settings.watch or {}, record)
        imus = [sensor.age_limit_s for sensor in machine.sensors_of("imu")]
        self.age_limit_s = max(imus, default=float("inf"))
        self._is_localised = False
        self._told: dict[str, str] = {}  # kind of the refusal of each sensor's newest observation
        self._is_fusing = True
        self.refused: Counter[str] = Counter()  # observations by sensor and kind of reason
        self.scans_not_fused = 0
        self.stale_states = 0  # of those that the report judges
        self.judged: Samples[BaseState] = Samples(_JUDGED)
        self._has_judge = settings.has_judge or registry.has_oracle(type(self._robot))
        tap(self._robot, "command", self._command)
        tap(self._robot, "stop", self._stop)

    def bind(self, streams: Streams) -> None:
        """Take the streams, whose states observations are compared with."""
        self._streams = streams

    def refuses(self, observation: object) -> bool:
        sensor, reason = self._gate.refusal(observation, self._now_s())
        if not sensor:
            return False
        kind = _kind(reason) if reason else ""
        self._ages.take(sensor, getattr(observation, "stamp_s", 0.0), reason)
        if reason:
            self.refused[f"{sensor}: {kind}"] += 1
            if self._told.get(sensor) != kind:
                stamp_s = float(getattr(observation, "stamp_s", 0.0))
                self._record(ObservationRefused(sensor, reason, stamp_s))
        self._told[sensor] = kind
        return bool(reason)

    def may_fuse(self, stamp_s: float, behind: int = 0) -> bool:
        reason = self._state_trouble(stamp_s)
        if behind >= MOST_BEHIND:
            reason = f"the map is {behind} scan pairs behind: this computer is too busy for it"
        if reason:
            self.scans_not_fused += 1
            if self._is_fusing:
                self._record(ScansNotFused(reason))
        self._is_fusing = not reason
        return not reason

    def step(self, now_s: float) -> Decision:
        """Look at every condition, and return what to do; once a tick.

        Args:
            now_s: Machine time at which the robot was read [s]. What the streams have computed
                since then makes no sample older.
        """
        troubles = dict(self._ages.troubles(now_s))
        for sensor, gaps in self._ages.gaps(now_s):
            if sensor not in troubles:  # its condition tells it otherwise
                self._record(SamplesMissing(sensor, gaps))
        sample = self._streams.joints if self._streams is not None else None
        if sample is not None:
            troubles |= self._motion.troubles(sample, self._watch.rules)
        if self._is_localised or self._state_is_ready():
            estimate = self._state_trouble(now_s)
            self._is_localised = self._is_localised or not estimate
            if estimate and self._is_localised and ESTIMATE in self._watch.rules:
                troubles[ESTIMATE] = estimate
        return self._watch.step(troubles, now_s)

    def missing(self) -> Mapping[str, int]:
        """Return how many samples of each sensor have not come, where any have not."""
        return self._ages.missing()

    def judge(self, state: BaseState) -> None:
        """Take a state that the report judges; one that is too old counts as the state of now.

        A frozen state is used at each tick as if it were new; its error is that of the present.
        """
        judged = self._judged(state, self._now_s())
        if self._has_judge:
            self.judged.append(judged)

    def _judged(self, state: BaseState, now_s: float) -> BaseState:
        if not stale(state, now_s, self.age_limit_s):
            return state
        self.stale_states += 1
        # Not dataclasses.replace: an estimator may return a subclass with another constructor.
        values = {one.name: getattr(state, one.name) for one in fields(BaseState)}
        return BaseState(**{**values, "stamp_s": now_s})

    def _state_trouble(self, at_s: float) -> str:
        """Return why the pose may not be used at a time [s]; without a rule its age counts."""
        if self._streams is None:
            return ""
        state, rule = self._streams.state(), self._watch.rules.get(ESTIMATE)
        if isinstance(rule, EstimateRule):
            why = self._streams.status_reason(state.status)
            return estimate_trouble(state, at_s, self.age_limit_s, rule, why)
        return stale(state, at_s, self.age_limit_s) if state.is_ready else ""

    def _state_is_ready(self) -> bool:
        return self._streams is not None and self._streams.state().is_ready

    def _now_s(self) -> float:
        return self._clock.machine_s()

    def _states(self) -> Sequence[Any]:
        return self._streams.recent_states() if self._streams is not None else ()

    def _datum(self) -> Float | None:
        datum = getattr(self._estimator, "datum", None)
        return None if datum is None else datum

    def _T_map_base(self) -> Float | None:
        if self._streams is None or not self._state_is_ready():
            return None
        return self._streams.state().T_map_base

    def _command(self, command: Callable[..., None], given: Any) -> None:
        command(given)  # a command that the robot refuses is none
        self._ages.command(given, self._now_s())
        self._motion.command(given, self._now_s())

    def _stop(self, stop: Callable[..., None]) -> None:
        self._motion.stopped()
        stop()


def failure_of(decision: Decision) -> FaultRecord:
    """Return the record of a condition that ends the mission."""
    return FaultRecord(
        component=f"watched condition '{decision.condition}'",
        capability="",
        name=decision.condition,
        verb="",
        node="",
        error=decision.reason,
        place="",
        traceback="",
    )


def _kind(reason: str) -> str:
    """Return a reason without its numbers, so that equal ones are counted together."""
    return re.sub(r"-?\d+(\.\d+)?(e[+-]?\d+)?", "…", reason)
