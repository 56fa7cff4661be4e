"""The age of each sensor's newest good sample, against its limit in the machine's file."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from executive.machine.machine import Machine
from executive.machine.sensor import Sensor
from executive.messages.command import Command, SwitchLidars

_WHOLE = 2.0  # periods until the first whole revolution after a lidar was switched on
_EPSILON_S = 1e-6


@dataclass(slots=True)
class _Stream:
    sensor: Sensor
    since_s: float  # stamp of the newest good sample, or the time from which on samples are due
    is_due: bool
    refused: str = ""  # why the newest sample was refused
    gaps: int = 0  # in which at least one sample was missing
    lost: int = 0  # samples that are missing in the present gap, at the last look

    def overdue(self, now_s: float) -> int:
        """Return how many samples are missing since the newest one.

        Only the next but one that is due proves that one is lost: the next may be on its way for
        nearly a period.
        """
        waited_s = now_s - self.since_s - self.sensor.latency_s
        return max(0, math.floor((waited_s + _EPSILON_S) * self.sensor.rate_hz) - 1)

    def skipped(self, stamp_s: float) -> int:
        """Return how many samples are missing between the newest one and a new one."""
        return max(0, round((stamp_s - self.since_s) * self.sensor.rate_hz) - 1)


class Ages:
    """Knows of each sensor whether good samples keep coming, and how many are missing.

    Args:
        machine: The sensors and their limits.
        lacks: Kinds of sensors that the robot does not have.
        now_s: The machine's time [s].
    """

    def __init__(self, machine: Machine, lacks: frozenset[str], now_s: float) -> None:
        self._streams = {
            name: _Stream(sensor, now_s, sensor.kind != "lidar")
            for name, sensor in machine.sensors.items()
            if sensor.kind not in lacks
        }
        self._missing: Counter[str] = Counter()  # samples by sensor, of gaps that are over

    def take(self, sensor: str, stamp_s: float, refusal: str) -> None:
        """Take a sample of a sensor, with the reason for which it was refused."""
        stream = self._streams.get(sensor)
        if stream is None:
            return
        if not refusal:
            if stream.is_due and not stream.refused and (skipped := stream.skipped(stamp_s)):
                self._missing[sensor] += skipped
                stream.gaps += not stream.lost
            stream.since_s, stream.lost = max(stream.since_s, stamp_s), 0
        stream.refused = refusal

    def command(self, command: Command, now_s: float) -> None:
        """Take a command: lidars are due only while they are on."""
        if not isinstance(command, SwitchLidars):
            return
        for stream in self._streams.values():
            if stream.sensor.kind == "lidar" and stream.is_due != command.on:
                stream.is_due = command.on
                stream.since_s = now_s + _WHOLE / stream.sensor.rate_hz

    def gaps(self, now_s: float) -> Iterator[tuple[str, int]]:
        """Yield each sensor in whose stream a gap has begun, with the number of its gaps so far.

        A gap is told when its number is a power of two, so that a poor stream fills no journal.
        """
        for name, stream in self._streams.items():
            before, stream.lost = stream.lost, 0
            if stream.is_due and not stream.refused:
                stream.lost = stream.overdue(now_s)
            if stream.lost and not before:
                stream.gaps += 1
                if stream.gaps & (stream.gaps - 1) == 0:
                    yield name, stream.gaps

    def missing(self) -> Mapping[str, int]:
        """Return how many samples of each sensor have not come so far, where any have not."""
        lost = Counter({name: stream.lost for name, stream in self._streams.items()})
        return dict(self._missing + lost)

    def troubles(self, now_s: float) -> Mapping[str, str]:
        """Return what is wrong with each sensor that is lost, by its name."""
        return {
            name: _told(stream, now_s)
            for name, stream in self._streams.items()
            if stream.is_due and now_s - stream.since_s > stream.sensor.age_limit_s + _EPSILON_S
        }


def _told(stream: _Stream, now_s: float) -> str:
    refused = f"; the newest one {stream.refused}" if stream.refused else ""
    return f"{stream.sensor.name}: no good sample for {now_s - stream.since_s:.2f} s{refused}"
