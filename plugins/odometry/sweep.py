"""A lidar's revolution, brought to one instant."""

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import log_so3
from executive.messages.lidar import LidarScan


def undistort(scan: LidarScan, T_from_to: Float, duration_s: float) -> Float:
    """Express the returns in the sensor's frame at the scan's stamp, as if it moved on as it last did.

    Args:
        scan: Each return in the sensor's frame at its own time.
        T_from_to: The last increment, the later pose in the earlier one, shape (4, 4).
        duration_s: The increment's duration [s].

    Returns:
        Points [m], shape (N, 3): p_end = exp(ξ (t − t_end)) p, rotation and translation apart, as between two ticks
        of a slow machine their coupling is below a millimetre.
    """
    share = (scan.point_stamps_s - scan.stamp_s) / duration_s
    rotation = log_so3(T_from_to[:3, :3])
    angle = float(np.linalg.norm(rotation))
    points = scan.points_lidar + share[:, None] * T_from_to[:3, 3]
    if angle < 1e-9:
        return np.asarray(points)
    axis = rotation / angle
    sine, cosine = np.sin(share * angle)[:, None], np.cos(share * angle)[:, None]
    turned = points * cosine + np.cross(axis, points) * sine + np.outer(points @ axis, axis) * (1 - cosine)
    return np.asarray(turned)
