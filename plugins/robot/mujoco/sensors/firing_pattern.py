"""The rays of one revolution of a spinning lidar, and their ranges to the link that carries it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, RayMesh, Rays, moved

from executive.arrays import Float, Int
from executive.geometry.pose import inverse
from executive.machine.sensor import Lidar

_LEAST = 1e-9  # in place of a part of a direction that is zero: 0.1 µm in 100 m


@dataclass(frozen=True, slots=True, eq=False)
class FiringPattern:
    """The rays of one revolution, column by column.

    Attributes:
        directions: Unit vectors in the lidar frame, shape (columns, lasers, 3).
        own_range_m: Range to the carrying link, inf where it is not hit, shape (columns · lasers,).
        free: Indices of the rays that do not hit the carrying link, rising, shape (M,).
        free_rays: Those rays in the lidar frame: origin 0 and direction, shape (M, 6).
        free_inverse: One over each part of their directions, finite, shape (3, M).
    """

    directions: Rays
    own_range_m: Float
    free: Int
    free_rays: Rays
    free_inverse: Rays


def firing_pattern(lidar: Lidar, columns: int, phase: float, own: Sequence[Mesh]) -> FiringPattern:
    """Return a revolution that begins a fraction (phase) of a column after azimuth 0."""
    azimuths = (np.arange(columns) + phase) * 2 * np.pi / columns
    elevations = np.linspace(*lidar.elevation_rad, lidar.lasers)
    flat, up = np.cos(elevations), np.sin(elevations)
    x, y = np.multiply.outer(np.cos(azimuths), flat), np.multiply.outer(np.sin(azimuths), flat)
    directions = np.stack([x, y, np.broadcast_to(up, x.shape)], axis=-1)
    rays = np.zeros((x.size, 6), dtype=np.float32)
    rays[:, 3:] = directions.reshape(-1, 3)
    T_lidar_link = inverse(lidar.T_link_sensor)
    own_range_m = RayMesh([moved(mesh, T_lidar_link) for mesh in own]).cast(rays).astype(np.float64)
    free = np.flatnonzero(np.isinf(own_range_m))
    along = np.where(np.abs(rays[free, 3:]) > _LEAST, rays[free, 3:], _LEAST)
    inverse_along = np.ascontiguousarray(1.0 / along.T, dtype=np.float32)
    flat_rays = rays[:, 3:].reshape(directions.shape)
    return FiringPattern(flat_rays, own_range_m, free, rays[free], inverse_along)
