"""One cloud with normals from the depth maps of many pictures."""

import itertools
from collections.abc import Callable, Iterable, Sequence

import numpy as np
import open3d as o3d
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from executive.arrays import Bool, Float, Int

CELL = np.dtype([("key", np.int64), ("sums", np.float64, 7)])
MOST = 2_000_000  # rows that are merged at a time: 64 bytes each, and as much to sort them

_NEIGHBOURS = 16  # of a point, for its normal
_SAMPLES = 1000  # of a part's rows: parts are larger or smaller than asked by some per cent


def below_flight(points: Float, centres: Float, margin_m: float) -> Bool:
    """Say which points (N, 3) lie below the outline of the cameras (C, 3),
    grown by a margin [m].
    """
    hull = ConvexHull(centres[:, :2])
    return np.asarray(
        (points[:, :2] @ hull.equations[:, :2].T + hull.equations[:, 2] <= margin_m).all(axis=1)
    )


def cells_of(points: Float, centre: Float, voxel_m: float) -> NDArray[np.void]:
    """Return the cells of a grid that the points of one picture are in.

    Args:
        points: Shape (N, 3) [m].
        centre: Of the picture's camera (3,) [m], in the frame of the points.
        voxel_m: Edge of a cell [m].

    Returns:
        Rows of `CELL`, each cell once, rising: its number, and the sums of its points, of the unit
        vectors from them to the camera, and of one for each point.
    """
    towards = (centre - points) / np.linalg.norm(centre - points, axis=1, keepdims=True)
    columns = (*points.T, *towards.T, np.ones(len(points)))
    return _added(_keys(points, voxel_m), columns)


def fuse(
    parts: Sequence[Callable[[], NDArray[np.void]]], fewest: int, most: int = MOST
) -> tuple[Float, Float]:
    """Merge the cells of many pictures and give them normals.

    The cells are merged by parts of the site, so that memory holds the cells of one part and the
    cloud, however many pictures there are; each cell is sorted once.

    Args:
        parts: Of each picture, reads its cells, which may be on the disk.
        fewest: Cells with fewer points are dropped.
        most: Rows that are merged at a time, as far as the pictures' cells can be divided so.

    Returns:
        Points, each the mean of a cell, and unit normals, which look to the cameras that saw them,
        (M, 3) each, in the order of the cells.
    """
    bounds = _bounds([part()["key"] for part in parts], most)
    merged = [np.empty((0, 6))]
    for low, high in itertools.pairwise(bounds):
        slices = (_between(part(), low, high) for part in parts)
        rows = np.concatenate([np.empty(0, dtype=CELL), *slices])
        sums = _added(rows["key"], rows["sums"].T)["sums"]
        sums = sums[sums[:, 6] >= fewest]
        merged.append(sums[:, :6] / sums[:, 6:])
    cells = np.concatenate(merged)
    return cells[:, :3], _normals(cells[:, :3], cells[:, 3:])


def _bounds(keys: Sequence[Int], most: int) -> list[int]:
    """Return rising numbers of cells, with about `most` rows, or less, from one to the next."""
    every = max(1, most // _SAMPLES)
    sample = np.sort(np.concatenate([np.empty(0, dtype=np.int64), *(k[::every] for k in keys)]))
    inner = np.unique(sample[_SAMPLES::_SAMPLES])
    return [np.iinfo(np.int64).min, *inner.tolist(), np.iinfo(np.int64).max]


def _between(cells: NDArray[np.void], low: int, high: int) -> NDArray[np.void]:
    """Return a copy of the rows whose numbers are from `low` on and below `high`."""
    first, last = np.searchsorted(cells["key"], [low, high])
    return np.array(cells[first:last])


def _keys(points: Float, voxel_m: float) -> Int:
    """Return the number of each point's cell; cells are counted from 2²⁰ edges below the
    origin on.
    """
    cells = np.floor(points / voxel_m).astype(np.int64) + 2**20
    return np.asarray((cells[:, 0] << 42) + (cells[:, 1] << 21) + cells[:, 2])


def _added(keys: Int, columns: Iterable[Float]) -> NDArray[np.void]:
    """Return each key once, rising, with the sum of each column of its rows."""
    unique, place = np.unique(keys, return_inverse=True)
    cells = np.empty(len(unique), dtype=CELL)
    cells["key"] = unique
    for k, column in enumerate(columns):
        cells["sums"][:, k] = np.bincount(place, weights=column, minlength=len(unique))
    return cells


def _normals(points: Float, towards: Float) -> Float:
    """Return the normal of the plane through each point's neighbours,
    on the side of its cameras.
    """
    if len(points) < 3:
        return towards
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.ascontiguousarray(points)))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(_NEIGHBOURS))
    normals = np.asarray(cloud.normals)
    return np.asarray(normals * np.where((normals * towards).sum(axis=1) < 0, -1.0, 1.0)[:, None])
