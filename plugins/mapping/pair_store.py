"""The newest scan pairs, so that the map can be rebuilt when their poses change."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from executive_plugins.mapping.pair_graph import Poses
from executive_plugins.mapping.scan_pair import SinglePrecision
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Bool, Float
from executive.geometry.pose import inverse, transform
from executive.geometry.rotation import angle_between


@dataclass(slots=True)
class _Stored:
    """A pair, the node that it belongs to, and its pose when it was inserted into the grid."""

    node: int
    points_cabin: SinglePrecision
    T_node_cabin: Float
    T_map_cabin: Float
    T_inserted: Float


class PairStore:
    """A map of voxels from pairs whose poses may still change.

    A pair that leaves the store stays in the map at its last pose, so that memory is bounded by the
    number of pairs. A pair cannot be removed from a grid of running means; the grid is rebuilt from
    all pairs instead, but only when it is read.
    """

    def __init__(self, voxel_m: float, memory: int, most_pairs: int, arm_m: float) -> None:
        """Start empty.

        Args:
            voxel_m: Edge of a voxel [m]; the grid is rebuilt when a pair moves by more than half of
            it.
            memory: Number of returns over which a voxel's mean is taken.
            most_pairs: Number of pairs whose points are kept.
            arm_m: Distance from the cabin at which the motion of a pair is measured [m].
        """
        self._half_voxel_m = 0.5 * voxel_m
        self._most_pairs = most_pairs
        self._arm_m = arm_m
        self._pairs: deque[_Stored] = deque()
        self._settled = VoxelGrid(voxel_m, memory)  # pairs that left the store
        self._grid = VoxelGrid(voxel_m, memory)
        self._is_stale = False

    def __len__(self) -> int:
        return len(self._pairs)

    @property
    def is_stale(self) -> bool:
        """Whether a pose has changed since the grid was built."""
        return self._is_stale

    def add(
        self, node: int, points_cabin: SinglePrecision, T_node_cabin: Float, T_map_node: Float
    ) -> None:
        """Insert a pair at T_map_node @ T_node_cabin."""
        T = T_map_node @ T_node_cabin
        if len(self._pairs) == self._most_pairs:
            oldest = self._pairs.popleft()
            self._settled.insert(_placed(oldest))
        self._pairs.append(_Stored(node, points_cabin, T_node_cabin, T, T))
        self._grid.insert(_placed(self._pairs[-1]))

    def move(self, poses: Poses) -> None:
        """Take new poses of the nodes."""
        for pair in self._pairs:
            i = pair.node - poses.first
            if 0 <= i < len(poses.T_map_cabin):
                pair.T_map_cabin = poses.T_map_cabin[i] @ pair.T_node_cabin
                self._is_stale |= self._motion_m(pair) > self._half_voxel_m

    def _motion_m(self, pair: _Stored) -> float:
        shift_m = np.linalg.norm(pair.T_map_cabin[:3, 3] - pair.T_inserted[:3, 3])
        return float(shift_m) + self._arm_m * angle_between(
            pair.T_inserted[:3, :3], pair.T_map_cabin[:3, :3]
        )

    def grid(self) -> VoxelGrid:
        """Return the map's voxels, rebuilt if a pair has moved: 100 ms for 300 pairs."""
        if self._is_stale:
            self._grid = self._settled.copy()
            for pair in self._pairs:
                pair.T_inserted = pair.T_map_cabin
                self._grid.insert(_placed(pair))
            self._is_stale = False
        return self._grid

    def forget_sphere(self, centre_map: Float, radius_m: float, least: int) -> int:
        """Remove a sphere from the grid and from all pairs, so that it stays removed.

        Returns:
            Number of occupied voxels that were removed.
        """
        removed = self.grid().forget_sphere(centre_map, radius_m, least)
        self._settled.forget_sphere(centre_map, radius_m, least)
        for pair in self._pairs:
            centre_cabin = transform(inverse(pair.T_map_cabin), centre_map)
            away = ((pair.points_cabin - centre_cabin.astype(np.float32)) ** 2).sum(
                axis=1
            ) > radius_m**2
            pair.points_cabin = pair.points_cabin[away]
        return removed

    def add_surface(self, points_map: Float) -> None:
        """Insert points [m] into the map permanently, shape (N, 3)."""
        self._settled.insert(points_map)
        self._grid.insert(points_map)

    def keep(self, is_kept: Callable[[Float], Bool]) -> None:
        """Remove the voxels that fail a test, and the pairs all of whose points fail it."""
        for grid in (self.grid(), self._settled):
            grid.keep(is_kept(grid.points()[0]))
        self._pairs = deque(pair for pair in self._pairs if is_kept(_placed(pair)).any())


def _placed(pair: _Stored) -> Float:
    return transform(pair.T_map_cabin, pair.points_cabin.astype(np.float64))
