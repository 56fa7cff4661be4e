"""Points gathered from a file piece by piece, thinned where they are too many, so that memory stays
small.
"""

import logging
from pathlib import Path

import numpy as np

from executive.arrays import Float, Int
from executive.errors import DataError

CHUNK = 1 << 18  # points read at a time
MOST = 1_500_000  # points kept: a disc of 10 m, a point each 1.4 cm
_MOST_READ = 500_000_000  # a minute; a file of holes may claim any number at no cost
_COARSER = 2**0.5
_FINEST_M = 0.01  # grid of the first thinning; the map's own is 3 cm


class PointCollector:
    """Keep the finite points of a file, in its order, and count what is left out.

    A coordinate that is not finite is how sensors mark a ray without a return: organised PCD files
    are full of them. More points than `MOST` are thinned as they come, to the first point in each
    cell of a grid: of 1 cm, or coarser until at most half of `MOST` are left. So memory does not
    grow with the file.
    """

    def __init__(self, path: Path, most: int) -> None:
        """Make room for at most so many points; memory is taken only as they come.

        Raises:
            DataError: If they are more than anyone would wait for.
        """
        if most > _MOST_READ:
            raise DataError(
                f"{path}: {most} points are more than {_MOST_READ:.0e}; thin or crop the cloud"
            )
        self._path = path
        self._points = np.empty((min(most, MOST + CHUNK), 3))
        self._kept = 0
        self._unfinite = 0
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
        with np.errstate(
            invalid="ignore"
        ):  # some single floats that are no number complain when they are widened
            piece[:, 0], piece[:, 1], piece[:, 2] = x, y, z
        finite = np.isfinite(piece).all(axis=1)
        self._unfinite += len(piece) - int(finite.sum())
        piece = piece if finite.all() else piece[finite]
        self._points[self._kept : self._kept + len(piece)] = piece
        self._kept += len(piece)

    def points(self) -> Float:
        """Return the points [m], shape (N, 3), each once; what was left out is told to the log.

        Raises:
            DataError: If none is left.
        """
        points = self._points[: self._kept]
        read = self._kept + self._unfinite + self._crowded
        if not read:
            raise DataError(f"{self._path}: holds no points; export the cloud again")
        if not len(points):
            raise DataError(
                f"{self._path}: none of its {read} points is finite; export the cloud again"
            )
        points, repeated = _once(points)
        crowd = f"are nearer than {100 * self._grid_m:.3g} cm to others"
        for number, what in (
            (self._unfinite, "are not finite"),
            (self._crowded, crowd),
            (repeated, "are there already"),
        ):
            if number:
                logging.getLogger(__name__).warning(
                    "%s: %d of %d points %s and are left out", self._path, number, read, what
                )
        return points

    def _thin(self) -> None:
        """Leave the first point in each cell, and room for as many again."""
        before = self._kept
        while True:
            first = _first(_digests(self._points[: self._kept], self._grid_m))
            for start in range(
                0, len(first), CHUNK
            ):  # rows only move forward: none is written before it is read
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

    By 64-bit digests: two of 10 million different points share one in 3 of a million clouds, and
    lose one of the two.
    """
    digests = _digests(points)
    ordered = np.sort(digests)
    repeated = int((ordered[1:] == ordered[:-1]).sum())
    if not repeated:
        return points, 0
    del ordered
    return points[_first(digests)], repeated


def _first(digests: np.ndarray) -> Int:
    """Return the rows of the first of each, in order."""
    first = np.unique(digests, return_index=True)[1]
    first.sort()
    return np.asarray(first)


def _digests(points: Float, grid_m: float | None = None) -> np.ndarray:
    """Return a number for each point, the same for all points in a cell of a grid; without one, for
    equal points.
    """
    digests = np.empty(len(points), dtype=np.uint64)
    for start in range(0, len(points), CHUNK):
        piece = points[start : start + CHUNK]
        digests[start : start + CHUNK] = _digest(
            piece if grid_m is None else np.floor(piece / grid_m)
        )
    return digests


def _digest(points: Float) -> np.ndarray:
    words = (points + 0.0).view(np.uint64)  # + 0.0: minus zero is zero
    mixed = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        mixed = (mixed ^ words[:, axis]) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed
