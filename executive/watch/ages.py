"""The age of each sensor's newest good sample, against its limit in the machine's file."""

from collections.abc import Mapping
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


class Ages:
    """Knows of each sensor whether good samples keep coming.

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

    def take(self, sensor: str, stamp_s: float, refusal: str) -> None:
        """Take a sample of a sensor, with the reason for which it was refused."""
        stream = self._streams.get(sensor)
        if stream is None:
            return
        stream.refused = refusal
        if not refusal:
            stream.since_s = max(stream.since_s, stamp_s)

    def command(self, command: Command, now_s: float) -> None:
        """Take a command: lidars are due only while they are on."""
        if not isinstance(command, SwitchLidars):
            return
        for stream in self._streams.values():
            if stream.sensor.kind == "lidar" and stream.is_due != command.on:
                stream.is_due = command.on
                stream.since_s = now_s + _WHOLE / stream.sensor.rate_hz

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
