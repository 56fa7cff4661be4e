"""The measurements that a smoother uses besides inertial samples.

They are plain values, so that they can be sent to another process.
"""

from dataclasses import dataclass, field

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Fix:
    """A position fix of one antenna in the map.

    Attributes:
        stamp_s: Time of measurement [s].
        antenna: Name of the antenna.
        arm_imu: The antenna in IMU axes [m], shape (3,).
        p_map_antenna: Measured position [m], shape (3,).
        covariance: In map axes [m²], shape (3, 3).
        late_s: By how much the receiver's stamp was thought to be late; it is not in `stamp_s` [s].
    """

    stamp_s: float
    antenna: str
    arm_imu: Float
    p_map_antenna: Float
    covariance: Float
    late_s: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Increment:
    """Motion of the IMU by lidar odometry.

    Attributes:
        from_s: Time of the earlier pose [s].
        stamp_s: Time of the later pose [s].
        T_from_to: Later IMU pose in the earlier one, shape (4, 4).
        covariance: As (rotation [rad], translation [m]) in the later IMU axes, shape (6, 6).
    """

    from_s: float
    stamp_s: float
    T_from_to: Float
    covariance: Float


@dataclass(frozen=True, slots=True, eq=False)
class Standstill:
    """The chassis is at rest, while the cabin may turn on it.

    Attributes:
        stamp_s: Time of the joint sample [s].
        arm_imu: A point on the turn axis in IMU axes [m], shape (3,).
        rate_imu: Angular velocity by the turn joint, IMU axes [rad/s], shape (3,); None while the
            cabin turns, since differentiated encoder readings are accurate at rest only.
        sway_m_s, sway_rad_s: See `ChassisRest`.
    """

    stamp_s: float
    arm_imu: Float
    rate_imu: Float | None
    sway_m_s: float = 0.0
    sway_rad_s: float = 0.0


Measurement = Fix | Increment | Standstill


@dataclass(order=True, frozen=True, slots=True)
class PendingMeasurement:
    """A measurement that is newer than the newest inertial sample; ordered by time."""

    stamp_s: float
    measurement: Measurement = field(compare=False)
