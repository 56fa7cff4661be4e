"""The height of uneven ground above its mean plane, as a stiff grid.

Deviation from Mascaro 2020, Sec. 4.3: there one plane with a margin of 10 cm is the ground. On
rough terrain slopes then stay in the cloud as false segments, and stones in hollows are cut too
high. Here the margin is measured from a grid that follows the ground over metres but is too stiff
to climb onto a stone.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.segmentation.ground_plane import plane_heights
from numba import njit
from scipy import sparse
from scipy.sparse.linalg import splu

from executive.arrays import Float, Int
from executive.errors import DataError

_MAX_NODES = 40_000  # 200 m × 200 m at nodes of 1 m; more is a wrong unit, not a site
_FULL_COUNT = 30.0  # points in a cell for its full weight
_ROUNDS = (1.0, 0.6, 0.4, 0.35)  # shrinking share of the relief that still may be ground
_ORIGIN = np.zeros(3)
_STENCIL = (1.0, -2.0, 1.0)  # second difference


@dataclass(frozen=True, slots=True, eq=False)
class GroundSurface:
    """Heights of the ground above a plane, on a grid in the plane's own axes.

    Attributes:
        plane: Unit normal n (up) and offset d with n·p = d [m], shape (4,).
        R_plane_cloud: Rows: two axes in the plane, then its normal, shape (3, 3).
        origin: Plane coordinates of node (0, 0) [m], shape (2,).
        node_m: Distance of nodes [m].
        heights_m: Height of each node above the plane [m], shape (nx, ny), both at least 2.
    """

    plane: Float
    R_plane_cloud: Float
    origin: Float
    node_m: float
    heights_m: Float

    def heights_above(self, points: Float, centre: Float = _ORIGIN) -> Float:
        """Return heights of points less a centre above the ground [m], (N, 3) → (N,); its border
        goes on outside.
        """
        frame = (self.R_plane_cloud, float(self.plane[3]), self.origin)
        return np.asarray(_heights(points, centre, frame, self.node_m, self.heights_m))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _heights(
    points: Float, centre: Float, frame: tuple[Float, float, Float], node_m: float, grid: Float
) -> Float:
    """Take each point's distance from the plane, and the bilinear height of the grid from that."""
    R, offset_m, origin = frame
    nx, ny = grid.shape
    heights = np.empty(len(points))
    for n in range(len(points)):
        x, y, z = points[n, 0] - centre[0], points[n, 1] - centre[1], points[n, 2] - centre[2]
        u = min(max((R[0, 0] * x + R[0, 1] * y + R[0, 2] * z - origin[0]) / node_m, 0.0), nx - 1.0)
        v = min(max((R[1, 0] * x + R[1, 1] * y + R[1, 2] * z - origin[1]) / node_m, 0.0), ny - 1.0)
        i, j = min(int(u), nx - 2), min(int(v), ny - 2)
        fu, fv = u - i, v - j
        low = grid[i, j] * (1 - fv) + grid[i, j + 1] * fv
        high = grid[i + 1, j] * (1 - fv) + grid[i + 1, j + 1] * fv
        above_plane = R[2, 0] * x + R[2, 1] * y + R[2, 2] * z - offset_m
        heights[n] = above_plane - (low * (1 - fu) + high * fu)
    return heights


def _axes(normal: Float) -> Float:
    x = np.cross([0.0, 1.0, 0.0], normal)
    x /= np.linalg.norm(x)
    return np.asarray(np.vstack([x, np.cross(normal, x), normal]))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _bending(nx: int, ny: int) -> tuple[Int, Int, Float]:
    """Return the matrix whose quadratic form is the bending of an nx × ny grid: rows, columns,
    values.

    Bending is the sum of squared second differences along both axes; the diagonal is there
    throughout.
    """
    strides, lengths = (ny, 1), (nx, ny)
    size = nx * ny + 9 * (max(nx - 2, 0) * ny + nx * max(ny - 2, 0))
    rows, columns, values = (
        np.empty(size, dtype=np.int64),
        np.empty(size, dtype=np.int64),
        np.empty(size),
    )
    for n in range(nx * ny):
        rows[n], columns[n], values[n] = n, n, 0.0
    count = nx * ny
    for n in range(nx * ny):
        place = (n // ny, n % ny)
        for a in range(2):
            if place[a] + 2 < lengths[a]:
                for i in range(3):
                    for j in range(3):
                        rows[count], columns[count] = n + i * strides[a], n + j * strides[a]
                        values[count] = _STENCIL[i] * _STENCIL[j]
                        count += 1
    return rows, columns, values


def _stiff(shape: tuple[int, ...], stiffness: float) -> tuple[sparse.csc_array, Int]:
    """Return the weighted bending, barely regular by itself, and where its diagonal lies in its
    data.
    """
    rows, columns, values = _bending(*shape)
    size = shape[0] * shape[1]
    system = sparse.coo_array((stiffness * values, (rows, columns)), shape=(size, size)).tocsc()
    diagonal = np.flatnonzero(system.indices == np.repeat(np.arange(size), np.diff(system.indptr)))
    system.data[diagonal] += 1e-4
    return system, diagonal


@njit(cache=True)  # type: ignore[untyped-decorator]
def _node_means(
    above: Float, heights: Float, nodes: Int, limits: tuple[float, float], size: int
) -> tuple[Float, Float]:
    """Return counts and mean heights of what may be ground, by nearest node."""
    counts, sums = np.zeros(size), np.zeros(size)
    for i in range(len(nodes)):
        if limits[0] < above[i] < limits[1]:
            counts[nodes[i]] += 1
            sums[nodes[i]] += heights[i]
    return counts, sums / np.maximum(counts, 1)


def fit_ground_surface(
    points: Float, plane: Float, node_m: float, relief_m: float, stiffness: float
) -> GroundSurface:
    """Lay a stiff grid onto the ground, leaving out step by step what rises from it.

    Args:
        points: The cloud, or a sample of it [m], shape (N, 3).
        plane: Mean plane of the ground, shape (4,).
        node_m: Distance of the grid's nodes [m].
        relief_m: Largest distance of ground from the plane [m].
        stiffness: Weight of bending against a cell full of points.

    Raises:
        DataError: If the cloud is too wide for any site.
    """
    R = _axes(plane[:3])
    uv = points @ R[:2].T
    origin = uv.min(axis=0)
    shape = tuple(int(n) for n in np.maximum(np.ceil(np.ptp(uv, axis=0) / node_m), 1) + 1)
    if shape[0] * shape[1] > _MAX_NODES:
        spans = " × ".join(f"{span:.0f}" for span in np.ptp(uv, axis=0))
        raise DataError(
            f"the cloud spans {spans} m, more than a site; crop it, or check that its "
            "unit is the metre"
        )
    nodes = np.rint((uv - origin) / node_m).astype(np.int64) @ np.array([shape[1], 1])
    size = shape[0] * shape[1]
    system, diagonal = _stiff(shape, stiffness)
    free = system.data[diagonal].copy()
    heights = plane_heights(points, plane)
    surface = GroundSurface(plane, R, origin, node_m, np.zeros(shape))
    for share in _ROUNDS:
        limits = (-share * relief_m, 0.5 * share * relief_m)  # stones only rise
        counts, means = _node_means(surface.heights_above(points), heights, nodes, limits, size)
        weights = np.minimum(counts / _FULL_COUNT, 1.0)
        system.data[diagonal] = free + weights
        surface = GroundSurface(
            plane, R, origin, node_m, splu(system).solve(weights * means).reshape(shape)
        )
    return surface
