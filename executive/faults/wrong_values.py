"""Wrong values of samples: random bits, offsets, and the slow wandering of a satellite fix."""

from dataclasses import replace

import numpy as np

from executive.arrays import Float
from executive.faults.description import EFFORTS, SensorFault
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.machine.machine import Machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation

# Default offsets by kind of sensor: what a wrong zero, a bent mounting or a wrong fix amounts to.
_JOINTS_RAD = 0.1
_RATE_RAD_S, _FORCE_PER_RATE = 0.1, 10.0  # m/s² for each rad/s: 1 m/s² at the default
_GNSS_M = 0.5
_RANGE_M = 0.3
_EFFORT_SHARE = 0.2
_WANDER_S = 20.0  # period of the reflected path's phase while nothing moves


def garbage(values: Float, rng: np.random.Generator) -> Float:
    """Return random values of the same shape: finite, of any size, as from a torn message."""
    exponents = rng.uniform(-3, 12, values.shape)
    return np.asarray(rng.choice((-1.0, 1.0), values.shape) * 10.0**exponents)


def offset_values(observation: Observation, fault: SensorFault, machine: Machine) -> Observation:
    """Return the observation with a constant offset on what the sensor has measured."""
    given = fault.offset
    if isinstance(observation, JointSample):
        if fault.sensor == EFFORTS:
            limits = [joint.max_effort for joint in machine.joints] + [machine.jaw.max_effort]
            share = _EFFORT_SHARE if given is None else given
            return replace(observation, effort=observation.effort + share * np.array(limits))
        away = _JOINTS_RAD if given is None else given
        return replace(observation, position=observation.position + away)
    if isinstance(observation, ImuSample):
        rate = _RATE_RAD_S if given is None else given
        return replace(
            observation,
            angular_velocity_rad_s=observation.angular_velocity_rad_s + rate,
            specific_force_m_s2=observation.specific_force_m_s2 + _FORCE_PER_RATE * rate,
        )
    if isinstance(observation, GnssFix):
        return moved(observation, np.array([_GNSS_M if given is None else given, 0.0, 0.0]))
    ranges = np.linalg.norm(observation.points_lidar, axis=1, keepdims=True)
    factor = 1.0 + (_RANGE_M if given is None else given) / np.maximum(ranges, 1e-9)
    return replace(observation, points_lidar=observation.points_lidar * factor)


def wandering(fix: GnssFix, size_m: float) -> GnssFix:
    """Return a fix that circles about its place with the phase of a reflected path."""
    phase = 2 * np.pi * fix.stamp_s / _WANDER_S
    return moved(fix, size_m * np.array([np.cos(phase), np.sin(phase), 0.5 * np.sin(phase)]))


def moved(fix: GnssFix, enu_m: Float) -> GnssFix:
    """Return a fix that is moved by a vector in east, north, up [m], shape (3,)."""
    at = enu_from_geodetic(fix.geodetic, fix.geodetic)
    return replace(fix, geodetic=geodetic_from_enu(at + enu_m, fix.geodetic))
