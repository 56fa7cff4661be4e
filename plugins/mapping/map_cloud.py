"""The cloud that a map of voxels gives, brought up to date where the map has changed."""

import numpy as np
from executive_plugins.mapping.column_store import EDGE, Columns, Pool, extent, fill, refresh
from executive_plugins.mapping.column_surface import Choice, count_columns, smooth, thin
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.settings import MapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float, Int, read_only
from executive.messages.cloud import Cloud

_MARGIN = 16  # columns around the window, so that it lasts while a map grows
_SPARE = 1.5  # voxels for which the pool has room, in those that there are


class MapCloud:
    """Reads a grid's surface; only columns beside changed voxels are computed anew.

    The result has the same bits as if all were computed anew. A thread may compute the cloud while
    another one goes on changing the grid: `take` copies what has changed, and has to be guarded
    against such changes; `read` takes the rest of the time, and touches the copy alone.
    """

    def __init__(self, settings: MapSettings) -> None:
        self._settings = settings
        self._grid: VoxelGrid | None = None
        self._columns: Columns | None = None
        self._pool, self._used = _empty_pool(0), 0
        self._points, self._first = np.empty((0, 3)), np.zeros(1, dtype=np.int32)

    @classmethod
    def compile(cls, settings: MapSettings) -> None:
        """Compile the inner loops."""
        grid = VoxelGrid(settings.voxel_m, 1)
        grid.insert(np.zeros((settings.min_points, 3)))
        warm_up = cls(settings)
        for _ in range(2):
            warm_up.cloud(grid, Cylinder(1.0))
            grid.insert(np.zeros((1, 3)))
        warm_up.counts(warm_up.current(grid), np.zeros(2), 1)

    def cloud(self, grid: VoxelGrid, cylinder: Cylinder) -> Cloud:
        """Return one point for each occupied voxel in the cylinder, in order of the voxels.

        Range noise is smoothed if `smoothing_m` is positive.
        """
        return self.read(*self.take(grid, cylinder))

    def take(self, grid: VoxelGrid, cylinder: Cylinder) -> tuple[Columns, Choice]:
        """Take over what has changed in the grid; return what `read` is given."""
        s = self._settings
        centre_map = cylinder.centre_map.copy()
        return self.current(grid), Choice(
            s.voxel_m, s.smoothing_m, s.memory, s.min_points, centre_map, s.radius_m
        )

    def read(self, columns: Columns, choice: Choice) -> Cloud:
        """Return the cloud of what was taken over last."""
        smooth(columns, self._pool, choice)
        self._points = thin(columns, self._pool, self._used, self._points, self._first)
        return Cloud("map", self._points)

    def counts(self, columns: Columns, centre_map: Float, reach_m: int) -> Int:
        """Return the number of occupied upright columns in each square metre of a square.

        On ground these are the points of the cloud, without the cost of smoothing them.

        Args:
            columns: What `current` returned.
            centre_map: Middle of the square [m], shape (2,).
            reach_m: Half its side [m].

        Returns:
            Along x and y, shape (2 reach_m, 2 reach_m).
        """
        least = self._settings.min_points
        centre = read_only(centre_map)
        return np.asarray(count_columns(columns, self._pool, least, centre, reach_m))

    def current(self, grid: VoxelGrid) -> Columns:
        """Return the columns of the grid as it is now, which are changed by the next call."""
        if grid is not self._grid:
            self._grid, self._columns = grid, None
        changed = grid.take_changes()
        if changed is not None and self._columns is not None:
            used = refresh(changed, grid.table(), self._columns, self._pool, self._used)
            if used >= 0:
                self._used = used
                return self._columns
        self._columns = self._laid_out(grid)
        return self._columns

    def _laid_out(self, grid: VoxelGrid) -> Columns:
        """Lay out all voxels of the grid anew."""
        low, high, voxels = extent(grid.table())
        if not voxels:
            low, high = np.zeros(2, dtype=np.int64), np.zeros(2, dtype=np.int64)
        spans = high - low + 1 + 2 * (EDGE + _MARGIN)
        count = int(spans[0] * spans[1])
        first, held, room = (np.zeros(count, dtype=np.int32) for _ in range(3))
        marks, sends = np.zeros(count, dtype=np.uint8), np.zeros(count, dtype=np.uint16)
        columns = Columns(low - EDGE - _MARGIN, spans, first, held, room, marks, sends)
        self._pool = _empty_pool(int(_SPARE * 2 * voxels) + 1)
        self._used = fill(grid.table(), columns, self._pool)
        self._points, self._first = np.empty((0, 3)), np.zeros(count + 1, dtype=np.int32)
        return columns


def _empty_pool(size: int) -> Pool:
    heights, counts, cells = (np.empty(size, dtype=np.int32) for _ in range(3))
    means, moved = np.empty((size, 3)), np.empty((size, 3))
    return Pool(heights, counts, means, moved, cells, np.empty(size, dtype=np.int8))
