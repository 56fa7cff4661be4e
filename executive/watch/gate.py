"""The gate of the streams: what cannot be true is refused where it enters, with its reason."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from executive.arrays import all_finite
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders, Imu, Lidar, Sensor
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.watch.antenna_check import AntennaCheck
from executive.watch.plausible import (
    JointBounds,
    TurnRate,
    fix_refusal,
    imu_refusal,
    scan_refusal,
)
from executive.watch.sources import sensor_of

# Reasons that say nothing of a value; the others name one.
NOT_FINITE = "holds values that are not finite"
FUTURE = "its stamp is in the future"
OUT_OF_ORDER = "its stamp is not after the one before"
REPEATED = "repeats the values of the one before"
NOT_FIXED = "its carrier-phase ambiguities are not resolved"


class Gate:
    """Checks each observation; what it refuses goes to no plugin.

    Args:
        machine: What the bounds come from.
        antennas: Compares fixes with the estimate.
        is_ideal: Whether the robot's sensors are ideal; equal values in a row are then no fault.
    """

    def __init__(self, machine: Machine, antennas: AntennaCheck, *, is_ideal: bool = False) -> None:
        self._machine, self._antennas, self._is_ideal = machine, antennas, is_ideal
        encoders = next(iter(machine.sensors_of("encoders")), None)
        self._encoders = "" if encoders is None else encoders.name
        self._imus = tuple(one for one in machine.sensors_of("imu") if isinstance(one, Imu))
        self._bounds = JointBounds(machine, encoders) if isinstance(encoders, Encoders) else None
        self._turn = TurnRate(machine)
        self._newest: dict[str, Any] = {}  # as they came, refused ones included
        self._good: dict[str, Any] = {}
        self._expected: JointSample | None = None  # where the joints are if a jump is none
        self.refused: Counter[tuple[str, str]] = Counter()  # by sensor and reason
        self._checks: dict[type, Callable[[Sensor, Any], str]] = {
            ImuSample: self._imu,
            GnssFix: self._fix,
            JointSample: self._joints,
            LidarScan: self._scan,
        }

    def refusal(self, observation: Any, now_s: float) -> tuple[str, str]:
        """Return the sensor and why an observation is refused; the reason is empty if it is not.

        Observations that are of no sensor of the machine are not refused: plugins may take them.
        """
        sensor = sensor_of(observation, self._machine)
        if sensor is None:
            return "", ""
        reason = self._stamp(sensor, observation, now_s) or self._values(sensor, observation)
        if not reason:
            self._good[sensor.name] = observation
        else:
            self.refused[sensor.name, reason.partition(":")[0]] += 1
        return sensor.name, reason

    def good(self, sensor: str) -> Any:
        """Return the newest observation of a sensor that was not refused, or None."""
        return self._good.get(sensor)

    def forget(self) -> None:
        """Drop what samples are compared with, after a hold: the joints may have moved."""
        self._expected = None

    def _stamp(self, sensor: Sensor, observation: Any, now_s: float) -> str:
        if not np.isfinite(observation.stamp_s):
            return NOT_FINITE
        if observation.stamp_s > now_s + 1 / sensor.rate_hz:
            return FUTURE
        before = self._good.get(sensor.name)
        if before is not None and observation.stamp_s <= before.stamp_s:
            return OUT_OF_ORDER
        return ""

    def _values(self, sensor: Sensor, observation: Any) -> str:
        every = observation.__dataclass_fields__  # fields() would filter them at each sample
        for name in every:
            value = getattr(observation, name)
            if isinstance(value, np.ndarray) and not all_finite(value):
                return NOT_FINITE
        before, self._newest[sensor.name] = self._newest.get(sensor.name), observation
        if before is not None and not (self._is_ideal or sensor.may_repeat):
            measured = [(n, getattr(observation, n)) for n in every if n not in _NOT_MEASURED]
            arrays = [(n, v) for n, v in measured if isinstance(v, np.ndarray) and v.size]
            if arrays and all(_are_equal(getattr(before, n), v) for n, v in arrays):
                return REPEATED
        return self._checks[type(observation)](sensor, observation)

    def _imu(self, sensor: Sensor, sample: ImuSample) -> str:
        if not isinstance(sensor, Imu):
            return ""
        reason = imu_refusal(sensor, sample)
        joints = self._good.get(self._encoders)
        for other in self._imus:
            seen = self._good.get(other.name)
            if reason or joints is None or seen is None or other.link == sensor.link:
                continue
            if self._are_beside(sensor, sample, seen, joints):
                reason = self._turn.refusal(sensor, sample, (other, seen), joints)
        return reason

    def _are_beside(self, sensor: Sensor, sample: ImuSample, *others: Any) -> bool:
        """Return whether others were measured at about the same time, so that they compare."""
        return all(abs(sample.stamp_s - one.stamp_s) <= 5 / sensor.rate_hz for one in others)

    def _fix(self, _: Sensor, fix: GnssFix) -> str:
        reason = fix_refusal(fix)
        if not (reason or fix.is_rtk_fixed):
            return NOT_FIXED
        return reason or self._antennas.refusal(fix)

    def _joints(self, sensor: Sensor, sample: JointSample) -> str:
        if self._bounds is None:
            return ""
        reason = self._bounds.refusal(sample)
        if reason:
            return reason
        before = self._expected or self._good.get(sensor.name)
        if before is not None:
            reason = self._bounds.step(before, sample)
        self._expected = _expected(before, sample) if reason and before is not None else None
        return reason

    def _scan(self, sensor: Sensor, scan: LidarScan) -> str:
        return scan_refusal(sensor, scan) if isinstance(sensor, Lidar) else ""


_NOT_MEASURED = frozenset({"point_stamps_s", "covariance_enu_m2"})


def _are_equal(before: np.ndarray, values: np.ndarray) -> bool:
    """Return whether arrays are equal; nearly always the first value tells that they are not."""
    if before.shape != values.shape or before.item(0) != values.item(0):
        return False
    return np.array_equal(before, values)


def _expected(before: JointSample, sample: JointSample) -> JointSample:
    """Return where the joints are at a sample's stamp by the speeds that it reports.

    A sample that has jumped is compared with this until it fits again, so that an offset that
    lasts stays refused.
    """
    dt_s = sample.stamp_s - before.stamp_s
    mean = (before.velocity + sample.velocity) / 2
    return replace(sample, position=before.position + mean * dt_s)
