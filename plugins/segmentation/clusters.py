"""Euclidean clusters as connected voxels: neighbours share a face, an edge or a corner."""

from itertools import product

import numpy as np
from executive_plugins.segmentation.union_find import root_of, set_labels
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int

_BITS = 21  # a voxel's index along an axis; three of them fill 63 bits
_BESIDE = np.array(  # each pair of neighbours once: 13 of 26
    [way for way in product((-1, 0, 1), repeat=3) if way > (0, 0, 0)]
)
_DENSE = 16  # voxels for each point, up to which the box is laid out: half the time of hashing
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
    low, steps, table = _table(points, voxel_m)
    voxels, keys = _voxels(points, voxel_m, low, steps, table)
    group_of, parents = np.empty(len(keys), dtype=np.int64), np.arange(len(keys))
    for i in range(len(points) - 1, -1, -1):
        group_of[voxels[i]] = groups[i]
    for v in range(len(keys)):
        for x, y, z in _BESIDE:
            key = keys[v] + x * steps[0] + y * steps[1] + z * steps[2]
            other = table[_slot(key, keys, table, steps)]
            if other >= 0 and group_of[other] == group_of[v]:
                a, b = root_of(parents, v), root_of(parents, other)
                parents[max(a, b)] = min(a, b)
    labels: Int = set_labels(parents, voxels)
    return labels


@njit(cache=True)  # type: ignore[untyped-decorator]
def _table(points: Float, voxel_m: float) -> tuple[Float, Int, NDArray[np.int32]]:
    """Return the lower corner of the box [m], shape (3,), by how much a voxel's key grows along the
    axes, shape (3,), and an empty table of voxels.

    In a small box the keys are places in the table, one voxel wider on all sides; in a large one
    the table is a hash table.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in range(len(points)):
        for a in range(3):
            low[a], high[a] = min(low[a], points[i, a]), max(high[a], points[i, a])
    counts = np.floor((high - low) / voxel_m) + 3.0
    if len(points) and counts.prod() <= _DENSE * len(points):
        across, up = int(counts[1]), int(counts[2])
        table = np.full(int(counts[0]) * across * up, -1, dtype=np.int32)
        return low, np.array([across * up, up, 1]), table
    size = 16
    while size < 2 * len(points):
        size *= 2
    return low, np.array([1 << (2 * _BITS), 1 << _BITS, 1]), np.full(size, -1, dtype=np.int32)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _voxels(
    points: Float, voxel_m: float, low: Float, steps: Int, table: NDArray[np.int32]
) -> tuple[Int, Int]:
    """Number the occupied voxels in a table: the voxel of each point, and the key of each voxel."""
    keys = np.empty(len(points), dtype=np.int64)
    voxels, count = np.empty(len(points), dtype=np.int64), 0
    for i in range(len(points)):
        key = 0
        for a in range(3):
            key += (int((points[i, a] - low[a]) / voxel_m) + 1) * steps[a]
        slot = _slot(key, keys, table, steps)
        if table[slot] < 0:
            table[slot] = count
            keys[count] = key
            count += 1
        voxels[i] = table[slot]
    return voxels, keys[:count]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _slot(key: int, keys: Int, table: NDArray[np.int32], steps: Int) -> int:
    """Return the place of a key in the table, or the empty one where it belongs."""
    if steps[1] != 1 << _BITS:
        return key
    # The bits of a product depend on the lower ones of its factors alone: the upper half is folded
    # onto the lower one between two products, or voxels of one y and z would share a place.
    mixed = key * _MIX
    slot = (((mixed ^ (mixed >> 32)) * _MIX) >> 24) & (len(table) - 1)
    while table[slot] >= 0 and keys[table[slot]] != key:
        slot = (slot + 1) & (len(table) - 1)
    return slot
