"""Which sensor of the machine an observation comes from."""

from executive.machine.machine import Machine
from executive.machine.sensor import Sensor
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan


def sensor_of(observation: object, machine: Machine) -> Sensor | None:
    """Return the sensor of the machine that an observation is of; None if it has no such one.

    A joint sample has no name of a sensor: a machine has one set of encoders.
    """
    if isinstance(observation, JointSample):
        return next(iter(machine.sensors_of("encoders")), None)
    if isinstance(observation, GnssFix):
        return machine.sensors.get(observation.antenna)
    if isinstance(observation, ImuSample | LidarScan):
        return machine.sensors.get(observation.frame)
    return None
