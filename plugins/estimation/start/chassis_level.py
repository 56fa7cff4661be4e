"""The upward direction by the accelerometer of a chassis at rest."""

from executive_plugins.estimation.start.chassis import StandstillDetector, TurnJoint

from executive.arrays import Float
from executive.machine.rig import Rig
from executive.machine.sensor import Imu


class ChassisLevel:
    """The chassis' inertial sensor as a level for the cabin, through the turn joint.

    Attributes:
        accel_bias_m_s2: Standard deviation of its accelerometer's bias at switch-on [m/s²].
    """

    def __init__(
        self, sensor: Imu, T_imu_cabin: Float, turn: TurnJoint, standing: StandstillDetector
    ) -> None:
        self.accel_bias_m_s2 = max(sensor.accel_bias_m_s2, 1e-3)
        self._R_base_sensor = sensor.T_link_sensor[:3, :3]
        self._R_imu_cabin = T_imu_cabin[:3, :3]
        self._turn = turn
        self._standing = standing

    @classmethod
    def of(
        cls, rig: Rig, name: str, T_imu_cabin: Float, turn: TurnJoint, standing: StandstillDetector
    ) -> "ChassisLevel | None":
        """Return the level of a rig; None if its chassis has no inertial sensor of that name."""
        sensor = rig.sensors.get(name)
        if not isinstance(sensor, Imu) or sensor.link == rig.cabin_link:
            return None
        return cls(sensor, T_imu_cabin, turn, standing)

    def up_imu(self, stamp_s: float) -> Float | None:
        """Return the upward direction in axes of the cabin's sensor, shape (3,).

        None unless the chassis is at rest and the turn joint's angle is known.
        """
        force = self._standing.force(stamp_s)
        if force is None or not self._turn.is_known:
            return None
        up = (
            self._R_imu_cabin
            @ self._turn.T_cabin_base(stamp_s)[:3, :3]
            @ self._R_base_sensor
            @ force
        )
        return up / (up @ up) ** 0.5
