"""One sample of an inertial measurement unit."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class ImuSample:
    """Angular velocity and specific force in the sensor's own frame.

    Attributes:
        stamp_s: Time of measurement [s].
        frame: Name of the sensor's frame in the machine's description, such as `imu_cabin`.
        angular_velocity_rad_s: Measured angular velocity of the sensor relative to inertial space,
            in its own axes, shape (3,).
        specific_force_m_s2: Measured acceleration minus gravity, in the sensor's axes, shape (3,);
            at rest it points up.
    """

    stamp_s: float
    frame: str
    angular_velocity_rad_s: Float
    specific_force_m_s2: Float

    def __post_init__(self) -> None:
        for name in ("angular_velocity_rad_s", "specific_force_m_s2"):
            object.__setattr__(self, name, checked(name, getattr(self, name), 3))
