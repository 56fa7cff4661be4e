"""Euclidean clusters as connected voxels: neighbours share a face, an edge or a corner."""

from itertools import product

import numpy as np
from executive_plugins.segmentation.union_find import root_of, set_labels
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int

_BITS = 21  # a voxel's index along an axis; three of them fill 63 bits
_OFFSETS = np.array(  # each pair of neighbours once: 13 of 26
    [
        (x << (2 * _BITS)) + (y << _BITS) + z
        for x, y, z in product((-1, 0, 1), repeat=3)
        if (x, y, z) > (0, 0, 0)
    ]
)
_MIX = 0x9E3779B97F4A7C1  # an odd constant that spreads neighbouring keys over the table


@njit(cache=True)  # type: ignore[untyped-decorator]
def connected_clusters(points: Float, groups: Int, voxel_m: float) -> Int:
    """Label the points of a cloud by connected component of its occupied voxels, never across
    groups.

    Gaps below one voxel never separate two clusters, gaps above two voxels always do; in between it
    depends on where the grid lies.
    The partition does not depend on the order of the points.

    Args:
        points: [m], shape (N, 3), less than 2²⁰ voxels wide.
        groups: Points of different groups do not join, shape (N,); of a voxel that holds several,
            the first counts.
        voxel_m: Grid edge [m].

    Returns:
        Labels from 0 in order of the points, shape (N,).
    """
    voxels, keys, table = _voxels(points, voxel_m)
    group_of, parents = np.empty(len(keys), dtype=np.int64), np.arange(len(keys))
    for i in range(len(points) - 1, -1, -1):
        group_of[voxels[i]] = groups[i]
    for v in range(len(keys)):
        for offset in _OFFSETS:
            other = table[_slot(keys[v] + offset, keys, table)]
            if other >= 0 and group_of[other] == group_of[v]:
                a, b = root_of(parents, v), root_of(parents, other)
                parents[max(a, b)] = min(a, b)
    labels: Int = set_labels(parents, voxels)
    return labels


@njit(cache=True)  # type: ignore[untyped-decorator]
def _voxels(points: Float, voxel_m: float) -> tuple[Int, Int, NDArray[np.int32]]:
    """Number the occupied voxels: the voxel of each point, the key of each voxel, and a hash table
    of voxels.
    """
    size = 16
    while size < 2 * len(points):
        size *= 2
    low = np.full(3, np.inf)
    for i in range(len(points)):
        for a in range(3):
            low[a] = min(low[a], points[i, a])
    table, keys = np.full(size, -1, dtype=np.int32), np.empty(len(points), dtype=np.int64)
    voxels, count = np.empty(len(points), dtype=np.int64), 0
    for i in range(len(points)):
        key = 0
        for a in range(3):
            key = (key << _BITS) + int((points[i, a] - low[a]) / voxel_m) + 1
        slot = _slot(key, keys, table)
        if table[slot] < 0:
            table[slot] = count
            keys[count] = key
            count += 1
        voxels[i] = table[slot]
    return voxels, keys[:count], table


@njit(cache=True)  # type: ignore[untyped-decorator]
def _slot(key: int, keys: Int, table: NDArray[np.int32]) -> int:
    """Return the place of a key in the table, or the empty one where it belongs."""
    slot = ((key * _MIX) >> 24) & (len(table) - 1)
    while table[slot] >= 0 and keys[table[slot]] != key:
        slot = (slot + 1) & (len(table) - 1)
    return slot
