"""Points gathered from a file piece by piece, so that no second copy of a large cloud is ever in memory."""

import logging
import os
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.errors import DataError

_POINT_BYTES = 24
CHUNK = 1 << 18  # points read at a time


class PointCollector:
    """Keep the finite points of a file, in its order, and count what is left out.

    A coordinate that is not finite is how sensors mark a ray without a return: organised PCD files are full of them.
    """

    def __init__(self, path: Path, most: int) -> None:
        """Make room for at most so many points; memory is taken only as they come.

        Raises:
            DataError: If they would take more than half of this computer's memory.
        """
        self._path = path
        room = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2
        if most * _POINT_BYTES > room:
            raise DataError(
                f"{path}: {most} points would take {most * _POINT_BYTES / 1e9:.1f} GB, this computer gives at most "
                f"{room / 1e9:.1f} GB; thin or crop the cloud"
            )
        self._points = np.empty((most, 3))
        self._kept = 0
        self._unfinite = 0

    def add(self, x: Float, y: Float, z: Float) -> None:
        """Add points by their coordinates [m], shape (N,) each, of any numeric type."""
        piece = np.empty((len(x), 3))
        with np.errstate(invalid="ignore"):  # some single floats that are no number complain when they are widened
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
        read = self._kept + self._unfinite
        if not read:
            raise DataError(f"{self._path}: holds no points; export the cloud again")
        if not len(points):
            raise DataError(f"{self._path}: none of its {read} points is finite; export the cloud again")
        points, repeated = _once(points)
        for number, what in ((self._unfinite, "are not finite"), (repeated, "are there already")):
            if number:
                logging.getLogger(__name__).warning(
                    "%s: %d of %d points %s and are left out", self._path, number, read, what
                )
        return points


def _once(points: Float) -> tuple[Float, int]:
    """Return the points without exact repetitions, in their order, and how many were left out.

    By 64-bit digests: two of 10 million different points share one in 3 of a million clouds, and lose one of the two.
    """
    digests = np.empty(len(points), dtype=np.uint64)
    for start in range(0, len(points), CHUNK):
        digests[start : start + CHUNK] = _digest(points[start : start + CHUNK])
    ordered = np.sort(digests)
    repeated = int((ordered[1:] == ordered[:-1]).sum())
    if not repeated:
        return points, 0
    del ordered
    first = np.unique(digests, return_index=True)[1]
    first.sort()
    return points[first], repeated


def _digest(points: Float) -> np.ndarray:
    words = (points + 0.0).view(np.uint64)  # + 0.0: minus zero is zero
    mixed = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        mixed = (mixed ^ words[:, axis]) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed
