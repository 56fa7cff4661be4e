"""What samples of all kinds have in common: the fields that were measured, and their change."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.faults.description import EFFORTS
from executive.machine.machine import Machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.watch.sources import sensor_of

# The fields of each kind that hold what the sensor has measured.
VALUES: Mapping[type, tuple[str, ...]] = {
    ImuSample: ("angular_velocity_rad_s", "specific_force_m_s2"),
    GnssFix: ("geodetic",),
    JointSample: ("position", "velocity", "effort"),
    LidarScan: ("points_lidar",),
}


def is_of(observation: object, target: str, machine: Machine) -> bool:
    """Return whether an observation is of a sensor, of a kind of sensors, or has efforts."""
    if target == EFFORTS:
        return isinstance(observation, JointSample)
    sensor = sensor_of(observation, machine)
    return sensor is not None and target in (sensor.name, sensor.kind)


def fields_of(observation: Observation, target: str) -> tuple[str, ...]:
    """Return the names of the fields that a fault of a target changes."""
    return ("effort",) if target == EFFORTS else VALUES[type(observation)]


def changed(observation: Observation, values: Mapping[str, Float]) -> Observation:
    """Return the observation with other values."""
    return replace(observation, **values)  # type: ignore[arg-type]


def unchecked(observation: Observation, values: Mapping[str, Float]) -> Observation:
    """Return the observation with values that its class would refuse, such as NaN.

    A driver that skips the checks hands over such samples.
    """
    copy: Any = object.__new__(type(observation))
    for one in fields(observation):
        object.__setattr__(copy, one.name, values.get(one.name, getattr(observation, one.name)))
    found: Observation = copy
    return found


def not_a_number(value: Float) -> Float:
    """Return an array of the same shape that holds NaN alone."""
    return np.full_like(value, np.nan)
