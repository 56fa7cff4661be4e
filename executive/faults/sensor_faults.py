"""The faults of sensors: each takes one sample of the sensor and gives none, one or several."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from executive.arrays import Float
from executive.faults.description import SensorFault
from executive.faults.samples import (
    changed,
    fields_of,
    is_of,
    not_a_number,
    unchecked,
)
from executive.faults.wrong_values import garbage, offset_values, wandering
from executive.machine.machine import Machine
from executive.machine.sensor import Sensor
from executive.messages.gnss import GnssFix
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.watch.sources import sensor_of

# Defaults of the settings that a fault may give, as numbers of the sensor's own periods.
_DELAY_PERIODS = 20
_SLOW_FACTOR = 10
_LOST_SHARE = 0.9
_CLOCK_JUMP_S = -1.0
_FLOAT_STD_M = 0.4  # of a fix whose carrier-phase ambiguities are not resolved


class FaultySensor(ABC):
    """One fault of one sensor or kind of sensors, while it is active."""

    def __init__(self, fault: SensorFault, machine: Machine, rng: np.random.Generator) -> None:
        self.fault, self._machine, self._rng = fault, machine, rng

    def is_of(self, observation: Observation) -> bool:
        """Return whether the fault is of the sensor that an observation comes from."""
        return is_of(observation, self.fault.sensor, self._machine)

    def sensor(self, observation: Observation) -> Sensor:
        """Return the sensor of an observation that the fault is of."""
        found = sensor_of(observation, self._machine)
        if found is None:
            raise LookupError(f"no sensor of {type(observation).__name__}")
        return found

    def begin(self) -> None:  # noqa: B027 - optional
        """Forget what an earlier span of the fault has left."""

    @abstractmethod
    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        """Return what arrives instead of an observation, at a mission time [s]."""

    def late(self, now_s: float) -> Sequence[Observation]:
        """Return what was held back and arrives now; asked at every read, active or not."""
        return ()


class Changed(FaultySensor):
    """The values of each sample are changed by a function of the sample."""

    def __init__(
        self,
        fault: SensorFault,
        machine: Machine,
        rng: np.random.Generator,
        change: Callable[["Changed", Observation], Observation],
    ) -> None:
        super().__init__(fault, machine, rng)
        self._change = change
        self.rng, self.machine = rng, machine

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        return (self._change(self, observation),)


class Silent(FaultySensor):
    """Sends nothing; silent efforts read zero, as without pressure in the cylinders."""

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        if self.fault.sensor == "efforts" and isinstance(observation, JointSample):
            return (replace(observation, effort=np.zeros_like(observation.effort)),)
        return ()


class Stuck(FaultySensor):
    """Repeats the values of the first sample, under new stamps."""

    def __init__(self, fault: SensorFault, machine: Machine, rng: np.random.Generator) -> None:
        super().__init__(fault, machine, rng)
        self._held: dict[str, Observation] = {}

    def begin(self) -> None:
        self._held.clear()

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        held = self._held.setdefault(self.sensor(observation).name, observation)
        if isinstance(observation, LidarScan) and isinstance(held, LidarScan):
            stamps = held.point_stamps_s + (observation.stamp_s - held.stamp_s)
            return (replace(held, stamp_s=observation.stamp_s, point_stamps_s=stamps),)
        values = {name: getattr(held, name) for name in fields_of(observation, self.fault.sensor)}
        return (changed(observation, values),)


class Slow(FaultySensor):
    """Sends only as many samples as a lower rate has."""

    def __init__(self, fault: SensorFault, machine: Machine, rng: np.random.Generator) -> None:
        super().__init__(fault, machine, rng)
        self._sent_s: dict[str, float] = {}

    def begin(self) -> None:
        self._sent_s.clear()

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        sensor = self.sensor(observation)
        rate_hz = self.fault.rate or sensor.rate_hz / _SLOW_FACTOR
        before_s = self._sent_s.get(sensor.name)
        if before_s is None:  # the first sample of the lower rate comes a period after its begin
            self._sent_s[sensor.name] = observation.stamp_s
            return ()
        if observation.stamp_s - before_s < 1.0 / rate_hz - 1e-9:
            return ()
        self._sent_s[sensor.name] = observation.stamp_s
        return (observation,)


class Delayed(FaultySensor):
    """Hands each sample over later than it was measured."""

    def __init__(self, fault: SensorFault, machine: Machine, rng: np.random.Generator) -> None:
        super().__init__(fault, machine, rng)
        self._waiting: list[tuple[float, Observation]] = []

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        delay_s = self.fault.delay or _DELAY_PERIODS / self.sensor(observation).rate_hz
        self._waiting.append((observation.stamp_s + delay_s, observation))
        return ()

    def late(self, now_s: float) -> Sequence[Observation]:
        arrived = [one for at_s, one in self._waiting if at_s <= now_s + 1e-9]
        self._waiting = [item for item in self._waiting if item[0] > now_s + 1e-9]
        return arrived


class Intermittent(FaultySensor):
    """Loses samples by chance; the first one of each sensor always, so that the fault begins."""

    def __init__(self, fault: SensorFault, machine: Machine, rng: np.random.Generator) -> None:
        super().__init__(fault, machine, rng)
        self._begun: set[str] = set()

    def begin(self) -> None:
        self._begun.clear()

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        name, has_luck = self.sensor(observation).name, self._rng.random() >= self._share
        if name in self._begun and has_luck:
            return (observation,)
        self._begun.add(name)
        return ()

    @property
    def _share(self) -> float:
        return self.fault.share or _LOST_SHARE


class Duplicate(FaultySensor):
    """Sends each sample twice."""

    def alter(self, observation: Observation, now_s: float) -> Sequence[Observation]:
        return observation, observation


def _clock_jump(one: Changed, observation: Observation) -> Observation:
    jump_s = _CLOCK_JUMP_S if one.fault.jump is None else one.fault.jump
    stamp_s = observation.stamp_s + jump_s
    if isinstance(observation, LidarScan):
        return replace(
            observation, stamp_s=stamp_s, point_stamps_s=observation.point_stamps_s + jump_s
        )
    return replace(observation, stamp_s=stamp_s)


def _nan(one: Changed, observation: Observation) -> Observation:
    names = fields_of(observation, one.fault.sensor)
    return unchecked(observation, {n: not_a_number(getattr(observation, n)) for n in names})


def _garbage(one: Changed, observation: Observation) -> Observation:
    names = fields_of(observation, one.fault.sensor)
    values: dict[str, Float] = {n: garbage(getattr(observation, n), one.rng) for n in names}
    return changed(observation, values)


def _wrong(one: Changed, observation: Observation) -> Observation:
    return offset_values(observation, one.fault, one.machine)


def _float(one: Changed, observation: Observation) -> Observation:
    if not isinstance(observation, GnssFix):
        return observation
    return replace(
        wandering(observation, _FLOAT_STD_M),
        covariance_enu_m2=_FLOAT_STD_M**2 * np.eye(3),
        is_rtk_fixed=False,
    )


def _multipath(one: Changed, observation: Observation) -> Observation:
    size_m = 0.3 if one.fault.offset is None else one.fault.offset
    return wandering(observation, size_m) if isinstance(observation, GnssFix) else observation


_CHANGES: dict[str, Callable[[Changed, Observation], Observation]] = {
    "garbage": _garbage,
    "wrong": _wrong,
    "wrong_fix": _wrong,
    "nan": _nan,
    "clock_jump": _clock_jump,
    "float": _float,
    "multipath": _multipath,
}
_CLASSES: dict[str, type[FaultySensor]] = {
    "silent": Silent,
    "stuck": Stuck,
    "slow": Slow,
    "delayed": Delayed,
    "intermittent": Intermittent,
    "duplicate": Duplicate,
}


def faulty_sensor(fault: SensorFault, machine: Machine, rng: np.random.Generator) -> FaultySensor:
    """Return what does a fault to the samples of its sensor."""
    if fault.how in _CHANGES:
        return Changed(fault, machine, rng, _CHANGES[fault.how])
    return _CLASSES[fault.how](fault, machine, rng)
