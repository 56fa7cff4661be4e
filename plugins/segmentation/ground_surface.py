"""The height of uneven ground above its mean plane, as a stiff grid.

Deviation from Mascaro 2020, Sec. 4.3: there one plane with a margin of 10 cm is the ground. On
rough terrain slopes then stay in the cloud as false segments, and stones in hollows are cut too
high. Here the margin is measured from a grid that follows the ground over metres but is too stiff
to climb onto a stone.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.segmentation.grid_solver import GridSolver
from executive_plugins.segmentation.ground_plane import plane_heights
from executive_plugins.segmentation.lower_cone import LowerCone, Relief
from numba import njit
from numpy.typing import NDArray
from scipy import sparse

from executive.arrays import Float, Int
from executive.errors import DataError

_MANY_NODES = 40_000  # 100 m × 100 m at nodes of 0.5 m; wider sites get coarser ones
_COARSER = 4.0  # times as far apart as asked for, beyond which a site gets more nodes instead
_MOST_NODES = 250_000  # 1 km × 1 km at nodes of 2 m
_COARSEST_M = 8.0  # nodes so far apart follow no ground: a wrong unit, not a site
_FULL_DENSITY = 40.0  # points in a square metre for the full weight of a node
_ROUNDS = (1.8, 1.2, 1.05)  # shrinking height below the surface that is ground, in margins
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
def _bending(nx: int, ny: int) -> tuple[NDArray[np.int32], NDArray[np.int32], Float]:
    """Return the matrix whose quadratic form is the bending of an nx × ny grid: rows, columns,
    values.

    Bending is the sum of squared second differences along both axes; the diagonal is there
    throughout.
    """
    strides, lengths = (ny, 1), (nx, ny)
    size = nx * ny + 9 * (max(nx - 2, 0) * ny + nx * max(ny - 2, 0))
    rows, columns, values = (
        np.empty(size, dtype=np.int32),
        np.empty(size, dtype=np.int32),
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
    values *= stiffness
    system = sparse.coo_array((values, (rows, columns)), shape=(size, size)).tocsc()
    nodes = np.arange(size, dtype=np.int32)
    diagonal = np.flatnonzero(system.indices == np.repeat(nodes, np.diff(system.indptr)))
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


def node_distance_m(span: Float, least_m: float) -> float:
    """Return the distance of nodes with which a grid of such sides (2,) is not too large [m].

    Raises:
        DataError: If the sides are those of no site.
    """
    area_m2 = np.prod(span + least_m)
    node_m = max(least_m, float(np.sqrt(area_m2 / _MANY_NODES)))
    if max(node_m, float(span.max()) / _MANY_NODES) > _COARSEST_M:
        told = " × ".join(f"{one:.0f}" for one in span)
        raise DataError(
            f"the cloud spans {told} m, more than a site; crop it, or check that its unit is "
            "the metre"
        )
    return min(node_m, max(_COARSER * least_m, float(np.sqrt(area_m2 / _MOST_NODES))))


@dataclass(frozen=True, slots=True, eq=False)
class LevelSample:
    """Points of a cloud in the axes of a plane, and how high ground may be there.

    Attributes:
        plane: Unit normal n (up) and offset d with n·p = d [m], shape (4,).
        points: [m], shape (N, 3).
        places: Positions along the plane [m], shape (N, 2).
        heights: Above the plane [m], shape (N,).
        origin: Least of the places [m], shape (2,).
        span: Sides of their box [m], shape (2,).
        node_m: Distance of nodes with which a grid over them is not too large [m].
        cone: How high ground may be.
    """

    plane: Float
    points: Float
    places: Float
    heights: Float
    origin: Float
    span: Float
    node_m: float
    cone: LowerCone


@dataclass(frozen=True, slots=True)
class SurfaceFit:
    """How ground is told from what stands on it.

    Attributes:
        node_m: Distance of the grid's nodes [m].
        margin_m: Height up to which points are ground [m].
        max_rise: Largest slope of the ground against its mean plane, as a tangent.
        stiffness: Weight of bending against a cell full of points.
    """

    node_m: float
    margin_m: float
    max_rise: float
    stiffness: float

    def level(self, points: Float, plane: Float) -> LevelSample:
        """Lay the axes of a plane through points.

        Args:
            points: The cloud, or a sample of it [m], shape (N, 3).
            plane: Mean plane of the ground, shape (4,).

        Raises:
            DataError: If the cloud is too wide for any site.
        """
        places, heights = points @ _axes(plane[:3])[:2].T, plane_heights(points, plane)
        origin = np.array([places[:, a].min() for a in range(2)])
        span = np.array([places[:, a].max() for a in range(2)]) - origin
        node_m = node_distance_m(span, self.node_m)
        cone = LowerCone.under(places, heights, node_m / 2, self.max_rise)
        return LevelSample(plane, points, places, heights, origin, span, node_m, cone)

    def on(self, sample: LevelSample) -> GroundSurface:
        """Lay a stiff grid onto the ground: what may be ground first, then what is close to it."""
        node_m, origin, heights = sample.node_m, sample.origin, sample.heights
        R = _axes(sample.plane[:3])
        shape = tuple(int(n) for n in np.maximum(np.ceil(sample.span / node_m), 1) + 1)
        nodes = np.rint((sample.places - origin) / node_m).astype(np.int64)
        nodes = nodes @ np.array([shape[1], 1])
        system, diagonal = _stiff(shape, self.stiffness)
        # Second differences grow with the square of the distance: the same ground bends as much.
        system.data *= (self.node_m / node_m) ** 4
        free = system.data[diagonal].copy()
        is_low = sample.cone.may_be_ground(heights, self.margin_m)
        above, solver = np.where(is_low, 0.0, np.inf), GridSolver(node_m <= self.node_m)
        surface = GroundSurface(sample.plane, R, origin, node_m, np.zeros(shape))
        for share in (1.0, *_ROUNDS):
            limits = (-share * self.margin_m, 0.5 * share * self.margin_m)  # stones only rise
            counts, means = _node_means(above, heights, nodes, limits, shape[0] * shape[1])
            weights = np.minimum(counts / (_FULL_DENSITY * node_m**2), 1.0)
            system.data[diagonal] = free + weights
            grid = solver.solved(system, weights * means).reshape(shape)
            surface = GroundSurface(sample.plane, R, origin, node_m, grid)
            above = surface.heights_above(sample.points)
        return surface

    def relief(self, sample: LevelSample) -> Relief:
        """Return which shares of the area are steeper than ground."""
        cell_m, margin_m = sample.node_m / 2, self.margin_m
        upside_down = LowerCone.under(sample.places, -sample.heights, cell_m, self.max_rise)
        return Relief(sample.cone.steep_share(margin_m), upside_down.steep_share(margin_m))
