"""Patches of a surface, and how convex the surface is between neighbouring ones.

Stones are nearly convex, and where two touch, the surface is concave (Stein et al. 2014, "Object
partitioning using local convexity"). A patch is what a cell of a grid holds; its normal is that of
the points about it.
"""

from dataclasses import dataclass

import numpy as np
import small_gicp
from numba import njit
from scipy.spatial import cKDTree

from executive.arrays import Float, Int

_NEIGHBOURS = 20  # points that a normal is fitted to
_REACH = 1.8  # distance of neighbouring patches, in the grid's edge: across a face, edge or corner
_BODY = 4.0  # radius about a patch whose points tell the inside from the outside, in the same unit
_FEW = 4000  # points by which the body about a patch is known
_LEAST_RISE = 0.5  # z of a normal from which the side that faces up is the outside


@dataclass(frozen=True, slots=True, eq=False)
class PatchGraph:
    """Patches, and pairs of neighbours.

    Attributes:
        patch_of: Patch of each point, shape (N,).
        pairs: Patches that are neighbours, shape (E, 2).
        angles_rad: By how much the surface turns away between them, positive where it is convex,
            shape (E,).
    """

    patch_of: Int
    pairs: Int
    angles_rad: Float


def patch_graph(points: Float, patch_m: float) -> PatchGraph:
    """Lay patches over points, z up [m], shape (N, 3)."""
    cells = np.floor((points - points.min(axis=0)) / patch_m).astype(np.int64)
    _, patch_of, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    patch_of = patch_of.reshape(-1)
    middles = _summed(points, patch_of, len(counts)) / counts[:, None]
    outward = _oriented(points, _normals(points), _bodies(points, middles, patch_m)[patch_of])
    normals = _summed(outward, patch_of, len(counts))
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-9)[:, None]
    pairs = cKDTree(middles).query_pairs(_REACH * patch_m, output_type="ndarray").astype(np.int64)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    one, other = pairs.T
    apart = middles[other] - middles[one]
    apart /= np.linalg.norm(apart, axis=1)[:, None]
    turns = np.einsum("ij,ij->i", normals[other] - normals[one], apart)
    return PatchGraph(patch_of, pairs, 2 * np.arcsin(np.clip(turns / 2, -1, 1)))


def _summed(values: Float, groups: Int, count: int) -> Float:
    columns = [np.bincount(groups, weights=column, minlength=count) for column in values.T]
    return np.column_stack(columns)


def _normals(points: Float) -> Float:
    cloud = small_gicp.PointCloud(points)
    small_gicp.estimate_normals(cloud, num_neighbors=_NEIGHBOURS)
    return np.array(cloud.normals()[:, :3])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _bodies(points: Float, middles: Float, patch_m: float) -> Float:
    """Return the mean of the points about each patch [m], which lies inside of a stone.

    All points are looked at: there are few.
    """
    few = points[:: max(len(points) // _FEW, 1)]
    square, bodies = (_BODY * patch_m) ** 2, np.empty((len(middles), 3))
    for m in range(len(middles)):
        x, y, z, count = 0.0, 0.0, 0.0, 0
        for n in range(len(few)):
            u, v, w = (
                few[n, 0] - middles[m, 0],
                few[n, 1] - middles[m, 1],
                few[n, 2] - middles[m, 2],
            )
            if u * u + v * v + w * w <= square:
                x, y, z, count = x + few[n, 0], y + few[n, 1], z + few[n, 2], count + 1
        if count:
            bodies[m, 0], bodies[m, 1], bodies[m, 2] = x / count, y / count, z / count
        else:
            bodies[m] = middles[m]
    return bodies


def _oriented(points: Float, normals: Float, bodies: Float) -> Float:
    """Turn normals outward: up where they rise, else away from the body that they are of."""
    away = np.einsum("ij,ij->i", points - bodies, normals)
    rises = np.abs(normals[:, 2]) > _LEAST_RISE
    signs = np.where(rises, normals[:, 2], away)
    return np.asarray(normals * np.where(signs < 0, -1.0, 1.0)[:, None])
