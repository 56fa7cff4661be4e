"""A sparse grid of voxels, each with the running mean of the points that fell into it."""

from typing import NamedTuple

import numpy as np
from executive_plugins.mapping.column_store import BITS, FREE, INDEX, Marks, Narrow, Table
from numba import njit

from executive.arrays import Bool, Float, Int, read_only
from executive.errors import DataError
from executive.geometry.radix_sort import radix_order

_HALF = 1 << (BITS - 1)
_LOAD = 0.6  # above it, collisions become too frequent
_FULL = 0.8  # share of that load up to which a table is used again: it would soon be full
_FIRST_CAPACITY = 1 << 18
_MIX = np.uint64(0x9E3779B97F4A7C15)  # 2⁶⁴ over the golden ratio, odd


@njit(cache=True)  # type: ignore[untyped-decorator]
def _slot(keys: Int, key: np.int64) -> np.int64:  # pragma: no cover - compiled
    """Return the row of a key, or the free row for it: open addressing, linear probing.

    The bits of a product depend on the lower ones of its factors alone, so that the upper half is
    folded onto the lower one between two products: without, keys of one y and z share a row.
    """
    mask = len(keys) - 1
    mixed = np.uint64(key) * _MIX
    mixed = (mixed ^ (mixed >> np.uint64(32))) * _MIX
    row = np.int64(mixed >> np.uint64(32)) & mask
    while keys[row] != FREE and keys[row] != key:
        row = (row + 1) & mask
    return row


class Changes(NamedTuple):
    """Rows of the table that changed since they were last read.

    Attributes:
        rows: In order of their first change; `number[0]` of them are used, shape (R,).
        number: Shape (1,).
        is_noted: Whether a row is among them, shape (R,).
    """

    rows: Narrow
    number: Int
    is_noted: Marks


@njit(cache=True)  # type: ignore[untyped-decorator]
def _note(row: int, changes: Changes) -> None:  # pragma: no cover - compiled
    """Remember that a row changed."""
    if changes.is_noted[row] == 0:
        changes.is_noted[row] = 1
        changes.rows[changes.number[0]] = row
        changes.number[0] += 1


@njit(cache=True)  # type: ignore[untyped-decorator]
def _erase_sphere(
    table: Table, changes: Changes, centre: Float, radius_m: float, least: int
) -> int:  # pragma: no cover - compiled
    """Empty the voxels in a sphere; return how many had at least so many points."""
    erased = 0
    for row in range(len(table.keys)):
        if table.keys[row] == FREE or table.counts[row] == 0:
            continue
        dx, dy = table.means[row, 0] - centre[0], table.means[row, 1] - centre[1]
        dz = table.means[row, 2] - centre[2]
        if dx * dx + dy * dy + dz * dz <= radius_m**2:
            erased += table.counts[row] >= least
            table.counts[row] = 0
            table.means[row, :] = 0.0
            _note(row, changes)
    return erased


@njit(cache=True)  # type: ignore[untyped-decorator]
def _insert(table: Table, changes: Changes, points: Float, voxel_m: float, memory: int) -> int:
    """Add points to their voxels' means; return how many voxels are new."""
    # pragma: no cover - compiled
    keys, counts, means = table.keys, table.counts, table.means
    added = 0
    for n in range(len(points)):
        i = np.int64(np.floor(points[n, 0] / voxel_m)) + _HALF
        j = np.int64(np.floor(points[n, 1] / voxel_m)) + _HALF
        k = np.int64(np.floor(points[n, 2] / voxel_m)) + _HALF
        key = (i << (2 * BITS)) | (j << BITS) | k
        row = _slot(keys, key)
        if keys[row] == FREE:
            keys[row] = key
            counts[row] = 0
            means[row, :] = 0.0
            added += 1
        _note(row, changes)
        counts[row] += 1
        weight = min(counts[row], memory)
        for axis in range(3):
            means[row, axis] += (points[n, axis] - means[row, axis]) / weight
    return added


@njit(cache=True)  # type: ignore[untyped-decorator]
def _refill(
    keys: Int, means: Float, counts: Int, old_keys: Int, old_means: Float, old_counts: Int
) -> None:
    """Put voxels into an empty table."""  # pragma: no cover - compiled
    for n in range(len(old_keys)):
        row = _slot(keys, old_keys[n])
        keys[row], counts[row] = old_keys[n], old_counts[n]
        for axis in range(3):
            means[row, axis] = old_means[n, axis]


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _used_rows(
    keys: Int, means: Float, counts: Int
) -> tuple[Int, Float, Int]:  # pragma: no cover - compiled
    """Return keys, means and counts of the voxels that have points, in order of their rows."""
    size = 0
    for row in range(len(keys)):
        size += counts[row] > 0
    used_keys, used_counts = np.empty(size, dtype=np.int64), np.empty(size, dtype=np.int64)
    used_means = np.empty((size, 3))
    n = 0
    for row in range(len(keys)):
        if counts[row] > 0:
            used_keys[n], used_counts[n] = keys[row], counts[row]
            for axis in range(3):
                used_means[n, axis] = means[row, axis]
            n += 1
    return used_keys, used_means, used_counts


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _sorted_rows(keys: Int, counts: Int) -> Int:  # pragma: no cover - compiled
    """Return the rows of voxels that have points, in order of their keys."""
    rows, found = np.empty(len(keys), dtype=np.int64), 0
    low, high = np.full(3, 1 << BITS), np.zeros(3, dtype=np.int64)
    for row in range(len(keys)):
        if keys[row] != FREE and counts[row] > 0:
            rows[found] = row
            found += 1
            for a in range(3):
                index = (keys[row] >> ((2 - a) * BITS)) & INDEX
                low[a], high[a] = min(low[a], index), max(high[a], index)
    rows = rows[:found]
    spans = high - low + 1
    dense = np.empty(found, dtype=np.int64)  # the same order in fewer digits
    for n in range(found):
        key = keys[rows[n]]
        x, y = (key >> (2 * BITS)) - low[0], ((key >> BITS) & INDEX) - low[1]
        dense[n] = (x * spans[1] + y) * spans[2] + (key & INDEX) - low[2]
    sorted_rows: Int = rows[radix_order(dense)]
    return sorted_rows


def _capacity_for(voxels: int, load: float = 0.5 * _LOAD) -> int:
    """Return the rows of a table that an expected number of voxels fills up to a load."""
    capacity = _FIRST_CAPACITY
    while voxels > load * capacity:
        capacity *= 2
    return capacity


@njit(cache=True)  # type: ignore[untyped-decorator]
def _erase(table: Table, changes: Changes, corners: Int, edge: int) -> int:
    """Empty the voxels of cubes; return how many had points."""  # pragma: no cover - compiled
    keys, counts = table.keys, table.counts
    erased = 0
    for corner in corners:
        for i in range(corner[0], corner[0] + edge):
            for j in range(corner[1], corner[1] + edge):
                for k in range(corner[2], corner[2] + edge):
                    key = ((i + _HALF) << (2 * BITS)) | ((j + _HALF) << BITS) | (k + _HALF)
                    row = _slot(keys, np.int64(key))
                    if keys[row] != FREE and counts[row] > 0:
                        counts[row] = 0
                        table.means[row, :] = 0.0
                        _note(row, changes)
                        erased += 1
    return erased


class VoxelGrid:
    """Voxels in a hash table of 40 bytes a row, with a load of at most 0.6.

    Inserting a million points takes about 50 ms.
    """

    def __init__(self, voxel_m: float, memory: int, expected: int = 0) -> None:
        """Start empty.

        Args:
            voxel_m: Edge of a voxel [m].
            memory: Number of points over which a mean is taken; the weight of older ones decays.
            expected: Number of voxels for which there is room at once; to grow takes up to 0.5 s.
        """
        self._voxel_m = voxel_m
        self._memory = memory
        self._size = 0
        self._keys = np.empty(0, dtype=np.int64)
        self._is_same: bool = False  # whether the table is that of the last `take_changes`
        self._ready = _capacity_for(expected, _LOAD) if expected else 0  # rows from the start
        self._allocate(self._ready or _FIRST_CAPACITY)
        if expected:
            self._clear()

    @classmethod
    def compile(cls) -> None:
        """Compile the inner loops."""
        warm_up = cls(1.0, 1)
        warm_up.insert(np.zeros((1, 3)))
        warm_up.keep(np.ones(1, dtype=bool))
        warm_up.erase(np.zeros((1, 3), dtype=np.int64), 1)
        warm_up.forget_sphere(np.zeros(3), 1.0, 1)
        warm_up.rows()

    def __len__(self) -> int:
        return int((self._counts > 0).sum())

    def insert(self, points: Float) -> None:
        """Add points to their voxels, shape (N, 3).

        Raises:
            DataError: If a point is farther than 2²⁰ voxels from the origin.
        """
        if len(points) and np.abs(points).max() >= self._voxel_m * (_HALF - 1):
            raise DataError(
                f"a point at {np.abs(points).max():.0f} m is beyond the map's "
                f"{self._voxel_m * _HALF:.0f} m: set the datum near the site"
            )
        if (self._size + len(points)) > _LOAD * len(self._keys):
            self._rebuild(np.flatnonzero(self._counts > 0), self._size + len(points))
        self._size += _insert(self.table(), self._changes, points, self._voxel_m, self._memory)

    def erase(self, corners: Int, edge: int) -> int:
        """Remove the voxels of cubes; return how many.

        Args:
            corners: Lowest voxel index of each cube, shape (K, 3).
            edge: Voxels along the edge of a cube.
        """
        return int(_erase(self.table(), self._changes, corners, edge))

    def points(self) -> tuple[Float, Int]:
        """Return the means [m] (N, 3) and numbers of points (N,), in order of the voxels."""
        rows = self._rows()
        return self._means[rows], self._counts[rows]

    def table(self) -> Table:
        """Return the hash table itself, for reading."""
        return Table(self._keys, self._counts, self._means)

    def take_changes(self) -> Int | None:
        """Return the rows of the table that changed since the last call, shape (K,).

        None if the table was made anew since: then every row may hold another voxel.
        """
        rows = self._changes.rows[: self._changes.number[0]].astype(np.int64)
        self._changes.is_noted[rows] = 0
        self._changes.number[0] = 0
        is_same, self._is_same = self._is_same, True
        return rows if is_same else None

    def rows(self) -> tuple[Int, Float, Int]:
        """Return keys (N,), means [m] (N, 3) and numbers of points (N,) as the table has them.

        To sort them, and to read the table in that order, takes ten times as long.
        """
        keys, means, counts = _used_rows(self._keys, self._means, self._counts)
        return keys, means, counts

    def refill(self, keys: Int, means: Float, counts: Int) -> None:
        """Replace the content by what `rows` returned."""
        self._make_room(len(keys))
        _refill(self._keys, self._means, self._counts, keys, means, counts)
        self._size = len(keys)

    def copy(self) -> "VoxelGrid":
        """Return an independent grid with the same content."""
        twin = VoxelGrid(self._voxel_m, self._memory)
        twin._allocate(len(self._keys))
        twin._keys[:], twin._means[:], twin._counts[:] = self._keys, self._means, self._counts
        twin._size = self._size
        return twin

    def forget_sphere(self, centre: Float, radius_m: float, least: int) -> int:
        """Remove the voxels in a sphere; return how many of them had at least `least` points."""
        sphere = read_only(centre), float(radius_m)
        return int(_erase_sphere(self.table(), self._changes, *sphere, least))

    def keep(self, kept: Bool) -> None:
        """Remove the voxels for which `kept` is False, in the order of `points`."""
        self._rebuild(self._rows()[kept], int(kept.sum()))

    def _rows(self) -> Int:
        return np.asarray(_sorted_rows(self._keys, self._counts))

    def _rebuild(self, rows: Int, expected: int) -> None:
        """Move some rows into a table for an expected number of voxels."""
        keys, means, counts = self._keys[rows], self._means[rows], self._counts[rows]
        self._make_room(expected)
        _refill(self._keys, self._means, self._counts, keys, means, counts)
        self._size = len(rows)

    def _make_room(self, voxels: int) -> None:
        """Empty the table, and make another one only where that of the start is too small."""
        is_enough = voxels <= _FULL * _LOAD * self._ready
        self._allocate(self._ready if is_enough else _capacity_for(voxels))

    def _clear(self) -> None:
        """Empty the table in place; only what is written to gets memory, which takes long."""
        self._keys.fill(FREE)
        for part in (self._means, self._counts, *self._changes):
            part.fill(0)
        self._is_same = False

    def _allocate(self, capacity: int) -> None:
        if capacity == self._ready and len(self._keys) == capacity:
            self._clear()
            return
        self._keys = np.full(capacity, FREE, dtype=np.int64)
        self._means = np.zeros((capacity, 3))
        self._counts = np.zeros(capacity, dtype=np.int64)
        self._changes = Changes(
            np.empty(capacity, dtype=np.int32),
            np.zeros(1, dtype=np.int64),
            np.zeros(capacity, dtype=np.uint8),
        )
        self._is_same = False
