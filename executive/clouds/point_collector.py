"""Points collected from a file piece by piece, thinned if they are too many for memory."""

import logging
from pathlib import Path

import numpy as np

from executive.arrays import Float, Int
from executive.errors import DataError

CHUNK = 1 << 18  # points read at a time
MOST = 1_500_000  # points kept: a disc of 10 m radius with a point every 1.4 cm
# Reading so many points takes a minute. A sparse file may claim any number without using the disk.
_MOST_READ = 500_000_000
_COARSER = 2**0.5  # factor on the grid of the next thinning
_FINEST_M = 0.01  # grid of the first thinning [m]; that of the map is 3 cm


class PointCollector:
    """Keep the finite points of a file, in its order, and count those that are left out.

    Sensors mark a ray without a return by coordinates that are not finite; organised PCD files have
    many of them. Whenever more than `MOST` points are held, they are thinned to the first point in
    each cell of a grid. The grid begins at 1 cm and becomes coarser until at most half of `MOST`
    points are left. So memory does not grow with the file.
    """

    def __init__(self, path: Path, most: int) -> None:
        """Reserve address space for points; the memory itself is used only as they arrive.

        Args:
            path: The file, for messages.
            most: Largest number of points that the file can hold.

        Raises:
            DataError: If they are so many that reading them would take minutes.
        """
        if most > _MOST_READ:
            raise DataError(
                f"{path}: {most} points are more than {_MOST_READ:.0e}; thin or crop the cloud"
            )
        self._path = path
        self._points = np.empty((min(most, MOST + CHUNK), 3))
        self._kept = 0
        self._not_finite = 0
        self._crowded = 0
        self._grid_m = _FINEST_M

    def add(self, x: Float, y: Float, z: Float) -> None:
        """Add points by their coordinates [m], shape (N,) each, of any numeric type."""
        for start in range(0, len(x), CHUNK):
            self._add(*(axis[start : start + CHUNK] for axis in (x, y, z)))
            if self._kept > MOST:
                self._thin()

    def _add(self, x: Float, y: Float, z: Float) -> None:
        piece = np.empty((len(x), 3))
        # Widening a signalling NaN from single to double precision would raise a warning.
        with np.errstate(invalid="ignore"):
            piece[:, 0], piece[:, 1], piece[:, 2] = x, y, z
        finite = np.isfinite(piece).all(axis=1)
        self._not_finite += len(piece) - int(finite.sum())
        piece = piece if finite.all() else piece[finite]
        self._points[self._kept : self._kept + len(piece)] = piece
        self._kept += len(piece)

    def points(self) -> Float:
        """Return the points [m], shape (N, 3), each once; log how many were left out and why.

        Raises:
            DataError: If no finite point was added.
        """
        points = self._points[: self._kept]
        read = self._kept + self._not_finite + self._crowded
        if not read:
            raise DataError(f"{self._path}: holds no points; export the cloud again")
        if not len(points):
            raise DataError(
                f"{self._path}: none of its {read} points is finite; export the cloud again"
            )
        points, repeated = _once(points)
        crowd = f"are nearer than {100 * self._grid_m:.3g} cm to others"
        for number, what in (
            (self._not_finite, "are not finite"),
            (self._crowded, crowd),
            (repeated, "repeat others"),
        ):
            if number:
                logging.getLogger(__name__).warning(
                    "%s: %d of %d points %s and are left out", self._path, number, read, what
                )
        return points

    def _thin(self) -> None:
        """Keep the first point in each cell, on a grid that leaves at most half of `MOST`."""
        before = self._kept
        while True:
            first = _first(_digests(self._points[: self._kept], self._grid_m))
            # In place: a row never moves to a higher index, so none is overwritten before its turn.
            for start in range(0, len(first), CHUNK):
                self._points[start : start + CHUNK][: len(first) - start] = self._points[
                    first[start : start + CHUNK]
                ]
            self._kept = len(first)
            if self._kept <= MOST // 2:
                break
            self._grid_m *= _COARSER
        self._crowded += before - self._kept


def _once(points: Float) -> tuple[Float, int]:
    """Return the points without exact repetitions, in their order, and how many were left out.

    Points are compared by 64-bit digests. In 3 of a million clouds of 10 million points two
    different points share a digest, and one of them is lost.
    """
    digests = _digests(points)
    ordered = np.sort(digests)
    repeated = int((ordered[1:] == ordered[:-1]).sum())
    if not repeated:
        return points, 0
    del ordered
    return points[_first(digests)], repeated


def _first(digests: np.ndarray) -> Int:
    """Return the rows at which each digest occurs first, in rising order."""
    first = np.unique(digests, return_index=True)[1]
    first.sort()
    return np.asarray(first)


def _digests(points: Float, grid_m: float | None = None) -> np.ndarray:
    """Return a hash of each point's cell in a grid, or of its coordinates if no grid is given."""
    digests = np.empty(len(points), dtype=np.uint64)
    for start in range(0, len(points), CHUNK):
        piece = points[start : start + CHUNK]
        digests[start : start + CHUNK] = _digest(
            piece if grid_m is None else np.floor(piece / grid_m)
        )
    return digests


def _digest(points: Float) -> np.ndarray:
    words = (points + 0.0).view(np.uint64)  # + 0.0 turns minus zero into zero
    mixed = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        mixed = (mixed ^ words[:, axis]) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed
