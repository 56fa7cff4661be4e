"""The newest scan pairs, so that the map can be made again when their poses have moved."""

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
    """A pair, the node that it hangs on, and where it was when it went into the grid."""

    node: int
    points_cabin: SinglePrecision
    T_node_cabin: Float
    T_map_cabin: Float
    T_inserted: Float


class PairStore:
    """A map of voxels from pairs with poses that may still move.

    What leaves the store stays in the map where it was last, so that memory is bounded by the
    number of pairs. A voxel grid of running means cannot give a pair back; it is made again from
    the pairs, but only when it is looked at.
    """

    def __init__(self, voxel_m: float, memory: int, most_pairs: int, arm_m: float) -> None:
        """Begin empty.

        Args:
            voxel_m: Edge of a voxel [m]; a pair is put in anew when it moves by more than half of
                it.
            memory: Returns over which a voxel's mean is taken.
            most_pairs: Pairs whose points are kept.
            arm_m: Distance from the cabin at which a pair's motion is told [m]: a turn moves what
                is far.
        """
        self._half_voxel_m = 0.5 * voxel_m
        self._most_pairs = most_pairs
        self._arm_m = arm_m
        self._pairs: deque[_Stored] = deque()
        self._settled = VoxelGrid(voxel_m, memory)  # what no longer moves
        self._grid = VoxelGrid(voxel_m, memory)
        self._is_stale = False

    def __len__(self) -> int:
        return len(self._pairs)

    @property
    def is_stale(self) -> bool:
        """Whether a pose has moved since the grid was made."""
        return self._is_stale

    def add(
        self, node: int, points_cabin: SinglePrecision, T_node_cabin: Float, T_map_node: Float
    ) -> None:
        """Put a pair into the map at a node's pose, seen from there at T_node_cabin."""
        T = T_map_node @ T_node_cabin
        if len(self._pairs) == self._most_pairs:
            oldest = self._pairs.popleft()
            self._settled.insert(_placed(oldest))
        self._pairs.append(_Stored(node, points_cabin, T_node_cabin, T, T))
        self._grid.insert(_placed(self._pairs[-1]))

    def move(self, poses: Poses) -> None:
        """Take the nodes' new poses."""
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
        """Return the map's voxels, made again from the pairs if one of them has moved: 100 ms for
        300 pairs.
        """
        if self._is_stale:
            self._grid = self._settled.copy()
            for pair in self._pairs:
                pair.T_inserted = pair.T_map_cabin
                self._grid.insert(_placed(pair))
            self._is_stale = False
        return self._grid

    def forget_sphere(self, centre_map: Float, radius_m: float, least: int) -> int:
        """Forget a sphere in the grid and in all pairs, so that it stays away; return the occupied
        voxels in it.
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
        """Put points into the map for good."""
        self._settled.insert(points_map)
        self._grid.insert(points_map)

    def keep(self, is_kept: Callable[[Float], Bool]) -> None:
        """Forget the voxels that a test refuses, and the pairs none of whose points pass it."""
        for grid in (self.grid(), self._settled):
            grid.keep(is_kept(grid.points()[0]))
        self._pairs = deque(pair for pair in self._pairs if is_kept(_placed(pair)).any())


def _placed(pair: _Stored) -> Float:
    return transform(pair.T_map_cabin, pair.points_cabin.astype(np.float64))
