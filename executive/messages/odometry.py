"""The motion of a lidar between two scans."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class LidarIncrement:
    """Relative pose of a sensor frame between two times.

    Attributes:
        from_s: Time of the earlier pose [s].
        to_s: Time of the later pose [s].
        frame: The sensor's frame in the machine's description.
        T_from_to: Later pose in the earlier one, shape (4, 4).
        covariance: Covariance of T_from_to as (rotation [rad], translation [m]) in the later frame,
            shape (6, 6).
    """

    from_s: float
    to_s: float
    frame: str
    T_from_to: Float
    covariance: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "T_from_to", checked("T_from_to", self.T_from_to, 4, 4))
        object.__setattr__(self, "covariance", checked("covariance", self.covariance, 6, 6))
