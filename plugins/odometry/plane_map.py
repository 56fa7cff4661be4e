"""A map of recent scans as small planes, for the registration of new scans."""

from dataclasses import dataclass

import numpy as np
import small_gicp
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float, Int
from executive.geometry.pose import transform
from executive.geometry.rotation import angle_between

_FEWEST = 6  # smallest number of points in a plane
_FLAT = 0.1  # largest ratio of a plane's variance across it to that along its shorter side


@dataclass(frozen=True, slots=True, eq=False)
class Planes:
    """P points with normals, shape (P, 3) each."""

    points: Float
    normals: Float


@dataclass(frozen=True, slots=True, eq=False)
class _KeyScan:
    T_map_lidar: Float
    points_map: Float


class PlaneMap:
    """The union of some scans, and the planes through its points.

    A lidar with few lasers draws rings. Along a single ring every normal across it fits, and a map
    of such normals moves with the sensor. A point is therefore used only if its neighbours spread
    in two directions.
    """

    def __init__(self, voxel_m: float, radius_m: float, neighbours: int, most_scans: int) -> None:
        self._voxel_m, self._radius_m, self._neighbours = voxel_m, radius_m, neighbours
        self._most_scans = most_scans
        self._scans: list[_KeyScan] = []
        self.planes = _planes(np.zeros((0, 3)), radius_m, neighbours)
        self._tree: cKDTree | None = None

    def add(self, T_map_lidar: Float, points_lidar: Float) -> None:
        """Add a scan; if there are too many, the scan farthest from it is removed.

        Of scans that are equally far, the oldest is removed.
        """
        self._scans.append(_KeyScan(T_map_lidar, transform(T_map_lidar, points_lidar)))
        if len(self._scans) > self._most_scans:
            distances = [
                np.linalg.norm(scan.T_map_lidar[:3, 3] - T_map_lidar[:3, 3]) for scan in self._scans
            ]
            del self._scans[int(np.argmax(distances))]
        cloud = small_gicp.voxelgrid_sampling(
            np.vstack([scan.points_map for scan in self._scans]), self._voxel_m, 1
        )
        self.planes = _planes(cloud.points()[:, :3], self._radius_m, self._neighbours)
        self._tree = cKDTree(self.planes.points) if len(self.planes.points) else None

    def is_new(self, T_map_lidar: Float, distance_m: float, angle_rad: float) -> bool:
        """Return whether no scan of the map was taken near a pose.

        Adding only such scans keeps the map free of drift while the cabin swings back and forth.
        """
        return not any(
            np.linalg.norm(scan.T_map_lidar[:3, 3] - T_map_lidar[:3, 3]) < distance_m
            and angle_between(scan.T_map_lidar[:3, :3], T_map_lidar[:3, :3]) < angle_rad
            for scan in self._scans
        )

    def nearest(self, points_map: Float, within_m: float) -> tuple[Bool, Int]:
        """Find the nearest plane of each point.

        Returns:
            Whether a point has a plane within reach, shape (N,), and the index of the nearest one
            for
            those that have.
        """
        if self._tree is None:
            return np.zeros(len(points_map), dtype=bool), np.zeros(0, dtype=np.int64)
        distance, index = self._tree.query(points_map, distance_upper_bound=within_m)
        found = np.isfinite(distance)
        return found, index[found]


def _planes(points: Float, radius_m: float, neighbours: int) -> Planes:
    """Fit a plane to each point's neighbourhood; keep those that are flat and wide enough."""
    if len(points) < _FEWEST:
        return Planes(np.zeros((0, 3)), np.zeros((0, 3)))
    distance, index = cKDTree(points).query(points, k=neighbours, distance_upper_bound=radius_m)
    is_near = np.isfinite(distance)[..., None]
    count = is_near.sum(axis=1)
    near = np.vstack([points, np.zeros(3)])[index]
    middle = (near * is_near).sum(axis=1) / count
    offsets = (near - middle[:, None]) * is_near
    covariance = np.einsum("nki,nkj->nij", offsets, offsets) / count[..., None]
    variance, axes = np.linalg.eigh(covariance)
    widest_ring_m = radius_m / 6
    is_plane = (count[:, 0] >= _FEWEST) & (variance[:, 1] > widest_ring_m**2)
    is_plane &= variance[:, 0] < _FLAT * variance[:, 1]
    return Planes(middle[is_plane], axes[is_plane, :, 0])
