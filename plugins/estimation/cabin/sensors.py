"""The sensors on the cabin that an estimator needs, from the rig's description."""

from collections.abc import Mapping

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import inverse, transform
from executive.machine.rig import Rig
from executive.machine.sensor import Imu


def cabin_imu(rig: Rig, name: str) -> Imu:
    """Return the inertial sensor of a name.

    Raises:
        ConfigError: If there is none of that name on the cabin.
    """
    sensor = rig.sensors.get(name)
    if not isinstance(sensor, Imu) or sensor.link != rig.cabin_link:
        names = [s.name for s in rig.sensors_of("imu") if s.link == rig.cabin_link]
        raise ConfigError(
            f"estimation: '{name}' is no imu on the cabin; there is: {', '.join(names)}"
        )
    return sensor


def antennas_in_imu(rig: Rig, imu: Imu) -> Mapping[str, Float]:
    """Return the antennas' phase centres in IMU axes [m], shape (3,) each, by name.

    Raises:
        ConfigError: If the cabin carries no antenna.
    """
    gnss = [s for s in rig.sensors_of("gnss") if s.link == rig.cabin_link]
    if not gnss:
        raise ConfigError(f"estimation: {rig.name} has no gnss antenna on the cabin; one is needed")
    return {s.name: transform(inverse(imu.T_link_sensor), s.T_link_sensor[:3, 3]) for s in gnss}
