"""Lets the faults of a mission act: on what the robot reports, on commands, and on plugins."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from executive.clock import Clock
from executive.events.event import Event
from executive.events.fault import FaultInjected, FaultRemoved, FaultShows
from executive.events.node import NodeStarted
from executive.faults.actuator_faults import FaultyActuator, Way
from executive.faults.description import ActuatorFault, Fault, PluginFault, SensorFault
from executive.faults.plugin_faults import misbehave
from executive.faults.sensor_faults import FaultySensor, faulty_sensor
from executive.faults.tap import tap
from executive.faults.timing import Schedule
from executive.interfaces.report import InjectedFault, SpanReport
from executive.machine.machine import Machine
from executive.messages.command import Command
from executive.messages.observation import Observation

DELAY_S = 5.0  # of a verb that is late, where the file gives none


@dataclass(slots=True)
class Armed:
    """One fault of the mission file, with its schedule.

    Attributes:
        number: Its number in the file, from 1.
        fault: What the file says.
        schedule: When it is active.
        is_active: Whether it was active at the last tick.
        acted: How many samples, commands or calls it has changed.
        spans: Begin and end of each time that it was active [s]; the end is None while it is.
        is_hidden: It has begun and cannot be seen yet.
    """

    number: int
    fault: Fault
    schedule: Schedule
    is_active: bool = False
    acted: int = 0
    spans: list[tuple[float, float | None]] = field(default_factory=list)
    is_hidden: bool = False


class Injector:
    """The faults of one mission; without faults it changes nothing."""

    def __init__(self, faults: Sequence[Fault], machine: Machine, seed: int, clock: Clock) -> None:
        self._clock, self._machine = clock, machine
        self._armed = [
            Armed(number, fault, Schedule(fault, _rng(seed, number, 0)))
            for number, fault in enumerate(faults, 1)
        ]
        self._sensors: list[tuple[Armed, FaultySensor]] = [
            (one, faulty_sensor(one.fault, machine, _rng(seed, one.number, 1)))
            for one in self._armed
            if isinstance(one.fault, SensorFault)
        ]
        self._actuators = [
            (one, FaultyActuator(one.fault, machine))
            for one in self._armed
            if isinstance(one.fault, ActuatorFault)
        ]
        self._way = Way(self.now_s)
        self._robot: Any = None
        self._command: Callable[[Command], None] = lambda command: None
        self._record: Callable[[Event], None] = lambda event: None

    def install(self, plugins: Mapping[str, Any], record: Callable[[Event], None]) -> None:
        """Act on a mission's plugins from now on, and record when a fault begins and ends."""
        self._record, self._robot = record, plugins["robot"]
        self._command = self._robot.command
        if self._sensors:
            tap(self._robot, "read", self._read)
        if self._actuators:
            tap(self._robot, "command", self._commanded)
            tap(self._robot, "stop", self._stopped)
        for capability, verb in sorted({target for _, target in self._targets()}):
            chosen = plugins.get(capability, ())
            for plugin in chosen if isinstance(chosen, tuple) else (chosen,):
                tap(plugin, verb, partial(self._called, capability, verb))

    def now_s(self) -> float:
        """Return the machine's time [s]; faults go on while the mission is held."""
        return self._clock.machine_s()

    def is_aimed_at(self, capability: str, verb: str) -> bool:
        """Return whether a fault of the mission is one of a verb."""
        return any(target == (capability, verb) for _, target in self._targets())

    def decide(self, capability: str, verb: str) -> PluginFault | None:
        """Return the fault of a call of a verb, or None; asked once a call."""
        for one, target in self._targets():
            fault = one.fault
            if target != (capability, verb) or not isinstance(fault, PluginFault):
                continue
            if one.is_active and (fault.calls is None or one.acted < fault.calls):
                one.acted += 1
                return fault
        return None

    def heed(self, node: str, event: Event) -> None:
        """Take an event of the journal: the start of a node may be what a fault waits for."""
        if isinstance(event, NodeStarted):
            for one in self._armed:
                one.schedule.node_started(node, self.now_s())

    def step(self) -> None:
        """Begin and end faults, and tell which show; called at the start of each tick."""
        now_s = self.now_s()
        for one in self._armed:
            if one.schedule.is_active(now_s) != one.is_active:
                self._turn(one, now_s)
        for one, actuator in self._actuators:
            if one.is_hidden:
                self._show(one, actuator)

    def report(self) -> tuple[InjectedFault, ...]:
        """Return the report's section on faults: what was injected, and when."""
        return tuple(
            InjectedFault(
                number=one.number,
                target=one.fault.target,
                how=str(one.fault.how),
                spans=tuple(SpanReport(from_s, to_s) for from_s, to_s in one.spans),
                acted=one.acted,
            )
            for one in self._armed
        )

    def _show(self, one: Armed, actuator: FaultyActuator) -> None:
        withheld = actuator.withheld(self._robot, self._way, one.spans[-1][0])
        if withheld > self._machine.stance.tracking_error:
            one.is_hidden = False
            self._record(FaultShows(one.number, withheld))

    def _turn(self, one: Armed, now_s: float) -> None:
        one.is_active = not one.is_active
        told = one.number, one.fault.target, str(one.fault.how)
        if one.is_active:
            one.spans.append((now_s, None))
            for armed, faulty in self._sensors:
                if armed is one:
                    faulty.begin()
            one.is_hidden = any(it.is_of_arm for armed, it in self._actuators if armed is one)
            self._record(FaultInjected(*told, one.is_hidden))
            for armed, actuator in self._actuators:
                if armed is one:
                    actuator.begin(self._robot, self._command, self._way)
                    one.acted += 1
        else:
            one.spans[-1], one.is_hidden = (one.spans[-1][0], now_s), False
            for armed, actuator in self._actuators:
                if armed is one:
                    actuator.end(self._robot)
            self._record(FaultRemoved(*told, one.acted))

    def _read(self, read: Callable[..., Sequence[Observation]], until_s: float) -> Any:
        """Read the robot, and let each active fault of a sensor act on what it reports."""
        observations = list(read(until_s))
        for one, faulty in self._sensors:
            observations = self._altered(one, faulty, observations, until_s)
        return observations

    def _commanded(self, command: Callable[[Command], None], given: Command) -> None:
        """Let each active fault of an actuator act on a command."""
        reaching: Command | None = given
        for one, actuator in self._actuators:
            if one.is_active and reaching is not None:
                altered = actuator.alter(reaching, self._robot)
                one.acted += altered is not reaching
                reaching = altered
        if reaching is not None:
            command(reaching)
            self._way.take(given, reaching)

    def _stopped(self, stop: Callable[[], None]) -> None:
        self._way.stop()
        stop()

    def _called(
        self, capability: str, verb: str, method: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        """Let an active fault act on a call that is no job."""
        fault = self.decide(capability, verb)
        if fault is None:
            return method(*args, **kwargs)
        return misbehave(fault.how, fault.delay or DELAY_S, lambda: method(*args, **kwargs))

    def _targets(self) -> Iterator[tuple[Armed, tuple[str, str]]]:
        for one in self._armed:
            if isinstance(one.fault, PluginFault):
                yield one, (one.fault.plugin, one.fault.verb)

    def _altered(
        self, one: Armed, faulty: FaultySensor, before: list[Observation], now_s: float
    ) -> list[Observation]:
        after: list[Observation] = list(faulty.late(now_s))
        for observation in before:
            if one.is_active and faulty.is_of(observation):
                after.extend(faulty.alter(observation, now_s))
                one.acted += 1
            else:
                after.append(observation)
        return after


def _rng(seed: int, number: int, purpose: int) -> np.random.Generator:
    """Return the generator of one fault: independent of all others, and of those of plugins."""
    return np.random.default_rng([seed, number, purpose, *b"faults"])
