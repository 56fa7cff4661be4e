"""Pose and velocity of the machine, and their uncertainty."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class BaseState:
    """Pose and twist of the chassis (`base`) and of the cabin, the body that carries the sensors.

    Attributes:
        stamp_s: Time of validity [s].
        T_map_base: Pose of the chassis in the map (east-north-up about the datum), shape (4, 4).
        T_odom_base: The same in the odometry frame, in which the pose has no jumps, shape (4, 4).
        T_map_cabin: Pose of the cabin, whose frame is that of the turn joint's child link, shape
            (4, 4).
        v_map_cabin: Velocity of the cabin's origin relative to the map, in map axes [m/s], shape
            (3,).
        w_map_cabin_in_cabin: Angular velocity of the cabin relative to the map, in cabin axes
            [rad/s], shape (3,).
        covariance: Covariance of T_map_cabin as (rotation [rad], translation [m]) in the cabin
            frame, shape (6, 6).
        status: `INITIALISING`, `ALIGNING` while the heading is not known (the covariance says so),
            or the estimator's mode, such as `GLOBAL` or `FALLBACK`.
    """

    stamp_s: float
    T_map_base: Float
    T_odom_base: Float
    T_map_cabin: Float
    v_map_cabin: Float
    w_map_cabin_in_cabin: Float
    covariance: Float
    status: str

    def __post_init__(self) -> None:
        for name in ("T_map_base", "T_odom_base", "T_map_cabin"):
            object.__setattr__(self, name, checked(name, getattr(self, name), 4, 4))
        for name in ("v_map_cabin", "w_map_cabin_in_cabin"):
            object.__setattr__(self, name, checked(name, getattr(self, name), 3))
        object.__setattr__(self, "covariance", checked("covariance", self.covariance, 6, 6))

    @property
    def is_ready(self) -> bool:
        """Whether the pose may be used."""
        return self.status not in ("INITIALISING", "ALIGNING")

    @property
    def is_located(self) -> bool:
        """Whether position and velocity may be used; the heading only as the covariance says."""
        return self.status != "INITIALISING"
