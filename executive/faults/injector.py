"""Lets the faults of a mission act: on what the robot reports, on commands, and on plugins."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from executive.clock import Clock
from executive.events.event import Event
from executive.events.fault import FaultInjected, FaultRemoved
from executive.events.node import NodeStarted
from executive.faults.description import Fault, SensorFault
from executive.faults.sensor_faults import FaultySensor, faulty_sensor
from executive.faults.tap import tap
from executive.faults.timing import Schedule
from executive.machine.machine import Machine
from executive.messages.observation import Observation


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
    """

    number: int
    fault: Fault
    schedule: Schedule
    is_active: bool = False
    acted: int = 0
    spans: list[tuple[float, float | None]] = field(default_factory=list)


class Injector:
    """The faults of one mission; without faults it changes nothing."""

    def __init__(self, faults: Sequence[Fault], machine: Machine, seed: int, clock: Clock) -> None:
        self._clock = clock
        self._armed = [
            Armed(number, fault, Schedule(fault, _rng(seed, number, 0)))
            for number, fault in enumerate(faults, 1)
        ]
        self._sensors: list[tuple[Armed, FaultySensor]] = [
            (one, faulty_sensor(one.fault, machine, _rng(seed, one.number, 1)))
            for one in self._armed
            if isinstance(one.fault, SensorFault)
        ]
        self._record: Callable[[Event], None] = lambda event: None

    def install(self, plugins: Mapping[str, Any], record: Callable[[Event], None]) -> None:
        """Act on a mission's plugins from now on, and record when a fault begins and ends."""
        self._record = record
        if self._sensors:
            tap(plugins["robot"], "read", self._read)

    def heed(self, node: str, event: Event) -> None:
        """Take an event of the journal: the start of a node may be what a fault waits for."""
        if isinstance(event, NodeStarted):
            for one in self._armed:
                one.schedule.node_started(node, self._clock.machine_s())

    def step(self) -> None:
        """Begin and end faults; called at the start of each tick."""
        now_s = self._clock.machine_s()
        for one in self._armed:
            if one.schedule.is_active(now_s) != one.is_active:
                self._turn(one, now_s)

    def report(self) -> list[dict[str, Any]]:
        """Return the report's section on faults: what was injected, and when."""
        return [
            {
                "number": one.number,
                "target": one.fault.target,
                "how": one.fault.how,
                "spans": [{"from_s": a, "to_s": b} for a, b in one.spans],
                "acted": one.acted,
            }
            for one in self._armed
        ]

    def _turn(self, one: Armed, now_s: float) -> None:
        one.is_active = not one.is_active
        told = one.number, one.fault.target, str(one.fault.how)
        if one.is_active:
            one.spans.append((now_s, None))
            for armed, faulty in self._sensors:
                if armed is one:
                    faulty.begin()
            self._record(FaultInjected(*told))
        else:
            one.spans[-1] = (one.spans[-1][0], now_s)
            self._record(FaultRemoved(*told, one.acted))

    def _read(self, read: Callable[..., Sequence[Observation]], until_s: float) -> Any:
        """Read the robot, and let each active fault of a sensor act on what it reports."""
        observations = list(read(until_s))
        for one, faulty in self._sensors:
            observations = self._altered(one, faulty, observations, until_s)
        return observations

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
