"""Points collected from a file piece by piece, thinned if they are too many for memory."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.carried_fields import CarriedFields
from executive.errors import DataError

CHUNK = 1 << 18  # points read at a time
MOST = 1_500_000  # points kept: a disc of 10 m radius with a point every 1.4 cm
MOST_APART = 6_000_000  # of those that are farther apart than what the maps keep
_APART_M = 0.03  # grid of the maps: a coarser one would lose stones of a wide site
# Reading so many points takes a minute. A sparse file may claim any number without using the disk.
_MOST_READ = 500_000_000
_COARSER = 2**0.5  # factor on the grid of the next thinning
_FINEST_M = 0.01  # grid of the first thinning [m]; that of the map is 3 cm


class PointCollector:
    """Keep the finite points of a file, in its order, and count those that are left out.

    Sensors mark a ray without a return by coordinates that are not finite; organised PCD files have
    many of them. Whenever more than `MOST` points are held, they are thinned to the first point in
    each cell of a grid. The grid begins at 1 cm and becomes coarser until at most half of `MOST`
    points are left; of points that are farther apart than 3 cm, as those of a site of a kilometre,
    up to `MOST_APART` are kept. So memory does not grow with the file.
    """

    def __init__(self, path: Path, most: int, fields: CarriedFields | None = None) -> None:
        """Reserve address space for points; the memory itself is used only as they arrive.

        Args:
            path: The file, for messages.
            most: Largest number of points that the file can hold.
            fields: Fields that are carried with the points; none if it is not given.

        Raises:
            DataError: If they are so many that reading them would take minutes.
        """
        if most > _MOST_READ:
            raise DataError(
                f"{path}: {most} points are more than {_MOST_READ:.0e}; thin or crop the cloud"
            )
        self._path, self._in_file = path, most
        self._most = MOST
        self._points = np.empty((min(most, MOST + CHUNK), 3))
        self._fields = fields if fields is not None and fields.names else None
        self._carried = (
            None if self._fields is None else np.empty(len(self._points), self._fields.layout)
        )
        self._kept = 0
        self._not_finite = 0
        self._crowded = 0
        self._grid_m = _FINEST_M

    def add(
        self,
        x: Float,
        y: Float,
        z: Float,
        source: Mapping[str, Any] | np.ndarray | None = None,
    ) -> None:
        """Add points by their coordinates [m], shape (N,) each, of any numeric type.

        Args:
            x: Coordinate along x.
            y: Coordinate along y.
            z: Coordinate along z.
            source: The carried fields by their names, shape (N,) each; needed if there are any.
        """
        rows = None
        if self._fields is not None and source is not None:
            rows = self._fields.rows(self._path, source)
        for start in range(0, len(x), CHUNK):
            piece = slice(start, start + CHUNK)
            self._add(x[piece], y[piece], z[piece], None if rows is None else rows[piece])
            if self._kept > self._most:
                self._thin()

    def _add(self, x: Float, y: Float, z: Float, rows: np.ndarray | None) -> None:
        piece = np.empty((len(x), 3))
        # Widening a signalling NaN from single to double precision would raise a warning.
        with np.errstate(invalid="ignore"):
            piece[:, 0], piece[:, 1], piece[:, 2] = x, y, z
        finite = np.isfinite(piece).all(axis=1)
        self._not_finite += len(piece) - int(finite.sum())
        piece = piece if finite.all() else piece[finite]
        here = slice(self._kept, self._kept + len(piece))
        self._points[here] = piece
        if self._carried is not None and rows is not None:
            self._carried[here] = rows[finite]
        self._kept += len(piece)

    def points(self) -> Float:
        """Return the points [m], shape (N, 3), each once; log how many were left out and why.

        Raises:
            DataError: If no finite point was added.
        """
        return self.with_carried()[0]

    def with_carried(self) -> tuple[Float, np.ndarray | None]:
        """Return the points as `points` does, and what is carried with them, shape (N,).

        Raises:
            DataError: If no finite point was added.
        """
        points = self._points[: self._kept]
        carried = None if self._carried is None else self._carried[: self._kept]
        read = self._kept + self._not_finite + self._crowded
        if not read:
            raise DataError(f"{self._path}: holds no points; export the cloud again")
        if not len(points):
            raise DataError(
                f"{self._path}: none of its {read} points is finite; export the cloud again"
            )
        once = _once(points)
        repeated = 0 if once is None else len(points) - len(once)
        if once is not None:
            points, carried = points[once], None if carried is None else carried[once]
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
        return points, carried

    def _thin(self) -> None:
        """Keep the first point in each cell, on a grid that leaves at most half of what may be
        kept, unless more are farther apart than what the maps keep.
        """
        before = self._kept
        while True:
            self._keep_first()
            if self._kept <= self._most // 2 or self._are_apart():
                break
            self._grid_m *= _COARSER
        self._crowded += before - self._kept

    def _keep_first(self) -> None:
        """Keep the first point in each cell of the grid."""
        first = first_in_cells(self._points[: self._kept], self._grid_m)
        _move_up(self._points, first)
        if self._carried is not None:
            _move_up(self._carried, first)
        self._kept = len(first)

    def _are_apart(self) -> bool:
        """Return whether the maps' grid leaves more than half: then more may be kept."""
        if self._most >= MOST_APART or self._grid_m >= _APART_M:
            return False
        if len(first_in_cells(self._points[: self._kept], _APART_M)) <= self._most // 2:
            return False
        self._most = MOST_APART
        self._points = self._with_room(self._points)
        self._carried = None if self._carried is None else self._with_room(self._carried)
        return True

    def _with_room(self, rows: np.ndarray) -> np.ndarray:
        """Return rows in an array with room for as many as may be kept now."""
        roomy = np.empty((min(self._in_file, MOST_APART + CHUNK), *rows.shape[1:]), rows.dtype)
        roomy[: self._kept] = rows[: self._kept]
        return roomy


def first_in_cells(points: Float, grid_m: float) -> Int:
    """Return the rows of the points (N, 3) [m] that are the first in their cell of a grid [m]."""
    return _first(_digests(points, grid_m))


def _move_up(rows: np.ndarray, kept: Int) -> None:
    """Move the kept rows to the beginning, in place.

    A row never moves to a higher index, so none is overwritten before its turn.
    """
    for start in range(0, len(kept), CHUNK):
        some = kept[start : start + CHUNK]
        rows[start : start + len(some)] = rows[some]


def _once(points: Float) -> Int | None:
    """Return the rows of the points without exact repetitions, in their order; None if none
    repeats another.

    Points are compared by 64-bit digests. In 3 of a million clouds of 10 million points two
    different points share a digest, and one of them is lost.
    """
    digests = _digests(points)
    ordered = np.sort(digests)
    repeats = bool((ordered[1:] == ordered[:-1]).any())
    del ordered
    return _first(digests) if repeats else None


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
