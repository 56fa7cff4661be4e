"""One cloud with normals from the depth maps of many pictures."""

from collections.abc import Iterable

import numpy as np
import open3d as o3d
from scipy.spatial import ConvexHull

from executive.arrays import Bool, Float, Int

_NEIGHBOURS = 16  # of a point, for its normal


def below_flight(points: Float, centres: Float, margin_m: float) -> Bool:
    """Say which points (N, 3) lie below the outline of the cameras (C, 3),
    grown by a margin [m].
    """
    hull = ConvexHull(centres[:, :2])
    return np.asarray(
        (points[:, :2] @ hull.equations[:, :2].T + hull.equations[:, 2] <= margin_m).all(axis=1)
    )


def fuse(parts: Iterable[tuple[Float, Float]], voxel_m: float, fewest: int) -> tuple[Float, Float]:
    """Merge points on a grid and give them normals.

    Args:
        parts: Of each picture, points (N, 3) [m] and its camera (3,); all in one frame.
        voxel_m: Edge of a cell [m]; a point is the mean of a cell.
        fewest: Cells with fewer points are dropped.

    Returns:
        Points and unit normals, which look to the cameras that saw them, (M, 3) each, in the order
        of the cells.
    """
    runs: list[tuple[Int, Float]] = []
    for seen, centre in parts:
        towards = (centre - seen) / np.linalg.norm(centre - seen, axis=1, keepdims=True)
        rows = np.column_stack([seen, towards, np.ones(len(seen))])
        # One part after the other is added to the cells: all points at once would take a gigabyte.
        # It is merged with runs of cells that are no larger, so that each cell is sorted anew a
        # few times, and not once for each picture.
        run = _added(_keys(seen, voxel_m), rows)
        while runs and len(runs[-1][0]) <= len(run[0]):
            run = _merged(runs.pop(), run)
        runs.append(run)
    keys, sums = np.empty(0, dtype=np.int64), np.empty((0, 7))
    while runs:
        keys, sums = _merged(runs.pop(), (keys, sums))
    merged = sums[sums[:, 6] >= fewest]
    merged = merged[:, :6] / merged[:, 6:]
    return merged[:, :3], _normals(merged[:, :3], merged[:, 3:])


def _keys(points: Float, voxel_m: float) -> Int:
    """Return the number of each point's cell; cells are counted from 2²⁰ edges below the
    origin on.
    """
    cells = np.floor(points / voxel_m).astype(np.int64) + 2**20
    return np.asarray((cells[:, 0] << 42) + (cells[:, 1] << 21) + cells[:, 2])


def _merged(one: tuple[Int, Float], other: tuple[Int, Float]) -> tuple[Int, Float]:
    """Return the cells of two runs, rising, each with the sum of its rows."""
    keys, rows = zip(one, other, strict=True)
    return _added(np.concatenate(keys), np.concatenate(rows))


def _added(keys: Int, rows: Float) -> tuple[Int, Float]:
    """Return each key once, rising, and the sum of its rows."""
    unique, place = np.unique(keys, return_inverse=True)
    return unique, np.stack(
        [np.bincount(place, weights=column, minlength=len(unique)) for column in rows.T], axis=1
    )


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
