"""One revolution of a spinning lidar."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class LidarScan:
    """Returns of one revolution, distorted by the sensor's motion meanwhile.

    Attributes:
        stamp_s: End of the revolution [s]; every point is at most one revolution older.
        frame: Name of the sensor's frame in the machine's description, such as `lidar_vertical`.
        points_lidar: Returns in the sensor's frame at each point's own time [m], shape (N, 3).
        point_stamps_s: Time of each return [s], shape (N,), not decreasing.
    """

    stamp_s: float
    frame: str
    points_lidar: Float
    point_stamps_s: Float

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "points_lidar", checked("points_lidar", self.points_lidar, None, 3)
        )
        stamps = checked("point_stamps_s", self.point_stamps_s, len(self.points_lidar))
        object.__setattr__(self, "point_stamps_s", stamps)
