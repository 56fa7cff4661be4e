"""The ground's slow undulation above its mean plane, as a stiff height grid.

Deviation from Mascaro 2020, Sec. 4.3: there one plane with a margin of 10 cm is the ground. On rough terrain slopes
then stay in the cloud as false segments, and stones in hollows are cut too high. Here the margin is measured from a
grid that follows the ground over metres but is too stiff to climb onto a stone.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy import sparse
from scipy.sparse.linalg import splu

from executive.arrays import Float
from executive.errors import DataError
from plugins.segmentation.ground_plane import plane_heights

_MAX_NODES = 40_000  # 200 m × 200 m at nodes of 1 m; more is a wrong unit, not a site
_FULL_COUNT = 30.0  # points in a cell for its full weight
_ROUNDS = (1.0, 0.6, 0.4, 0.35)  # shrinking share of the relief that still may be ground


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
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

    def heights_above(self, points: Float) -> Float:
        """Return heights above the ground [m], shape (N, 3) → (N,); beyond the grid its border goes on."""
        offset_m = float(self.plane[3])
        return np.asarray(_heights(points, self.R_plane_cloud, offset_m, self.origin, self.node_m, self.heights_m))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _heights(points: Float, R: Float, offset_m: float, origin: Float, node_m: float, grid: Float) -> Float:
    """Take each point's distance from the plane, and the bilinear height of the grid from that."""
    nx, ny = grid.shape
    heights = np.empty(len(points))
    for n in range(len(points)):
        x, y, z = points[n]
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


def _second_differences(nx: int, ny: int) -> sparse.csr_matrix:
    """Return the operator whose squared norm is the bending of an nx × ny grid."""

    def along(n: int) -> sparse.csr_matrix:
        return sparse.diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(max(n - 2, 0), n)).tocsr()

    bend_x = sparse.kron(along(nx), sparse.eye_array(ny))
    bend_y = sparse.kron(sparse.eye_array(nx), along(ny))
    return sparse.vstack([bend_x, bend_y]).tocsr()


def fit_terrain(points: Float, plane: Float, node_m: float, relief_m: float, stiffness: float) -> Terrain:
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
        raise DataError(f"the cloud spans {spans} m, more than a site; crop it, or check that its unit is the metre")
    cells = np.rint((uv - origin) / node_m).astype(np.int64) @ np.array([shape[1], 1])
    bending = _second_differences(*shape)
    heights = plane_heights(points, plane)
    terrain = Terrain(plane, R, origin, node_m, np.zeros(shape))
    stiff = stiffness * (bending.T @ bending) + 1e-4 * sparse.eye_array(shape[0] * shape[1])
    for share in _ROUNDS:
        above = terrain.heights_above(points)
        ground = (above > -share * relief_m) & (above < 0.5 * share * relief_m)  # stones only rise
        counts = np.bincount(cells[ground], minlength=stiff.shape[0])
        sums = np.bincount(cells[ground], heights[ground], minlength=stiff.shape[0])
        weights = np.minimum(counts / _FULL_COUNT, 1.0)
        means = sums / np.maximum(counts, 1)
        solved = splu((stiff + sparse.diags_array(weights)).tocsc()).solve(weights * means)
        terrain = Terrain(plane, R, origin, node_m, solved.reshape(shape))
    return terrain
