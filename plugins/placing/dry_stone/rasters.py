"""Height maps of a stone from above and from below, and of a structure as it stands."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.ndimage import maximum_filter

from executive.arrays import Float, Int
from executive.messages.building import AsBuilt

_BESIDE_M = 0.10  # beyond its rim, a neighbour is beside a stone that is let go with some noise
_MARGIN_M = 0.6  # around the foot of the envelope: stones that stick out are seen
_BARRED_M = 1e3  # above what lies around a structure: no stone comes to lie so high


@dataclass(frozen=True, slots=True, eq=False)
class StoneRaster:
    """A stone in one orientation, over the nodes of a grid through its origin.

    Attributes:
        R: Rotation of the stone, shape (3, 3).
        first: Index of the first node relative to the stone's origin, (2,).
        under: Height of its underside above its origin, infinite off the stone [m], shape (I, J).
        over: Height of its upper side, minus infinite off the stone [m], shape (I, J).
    """

    R: Float
    first: Int
    under: Float
    over: Float


def raster_of(vertices: Float, triangles: Int, R: Float, cell_m: float) -> StoneRaster:
    """Return the height maps of a surface turned by `R`."""
    turned = vertices @ R.T
    low = np.floor(turned[:, :2].min(axis=0) / cell_m).astype(np.int64)
    high = np.ceil(turned[:, :2].max(axis=0) / cell_m).astype(np.int64)
    shape = high - low + 1
    under, over = np.full(shape, np.inf), np.full(shape, -np.inf)
    at = turned.copy()
    at[:, :2] = turned[:, :2] / cell_m - low
    _fill(at, triangles, under, over)
    return StoneRaster(R, low, under, over)


@njit(cache=True)
def _fill(at, triangles, under, over):  # type: ignore[no-untyped-def]
    """Write the lowest and highest surface over each node; corners are in cells along x and y."""
    for n in range(triangles.shape[0]):
        a, b, c = at[triangles[n, 0]], at[triangles[n, 1]], at[triangles[n, 2]]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-12:
            continue
        for i in range(
            int(np.ceil(min(a[0], b[0], c[0]))), int(np.floor(max(a[0], b[0], c[0]))) + 1
        ):
            for j in range(
                int(np.ceil(min(a[1], b[1], c[1]))), int(np.floor(max(a[1], b[1], c[1]))) + 1
            ):
                u = ((i - a[0]) * (c[1] - a[1]) - (j - a[1]) * (c[0] - a[0])) / area
                v = ((b[0] - a[0]) * (j - a[1]) - (b[1] - a[1]) * (i - a[0])) / area
                if u < -1e-9 or v < -1e-9 or u + v > 1 + 1e-9:
                    continue
                z = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
                under[i, j] = min(under[i, j], z)
                over[i, j] = max(over[i, j], z)


class WallTop:
    """The surface on which the next stone comes to lie, seen from above.

    Attributes:
        cell_m: Distance of nodes [m].
        corner: Index of the first node from the map's origin, (2,).
        top: Height of what is highest there [m], beyond all heights where something lies that is
            none of the structure, shape (I, J).
        owner: Number of the stone that it belongs to, −1 on the ground, shape (I, J).
        ground: Height of the ground [m], shape (I, J).
        room: How deep each node is in the envelope at the foot: from the left face, from the right
            face, and from the nearer end [m], shape (3, I, J).
        raised: The highest top within `astray_m` [m], shape (I, J).
        near: The highest top of the structure within 10 cm [m], shape (I, J).
    """

    def __init__(self, built: AsBuilt, cell_m: float, astray_m: float = 0.0) -> None:
        self.cell_m = cell_m
        low, high = built.structure.bounds()
        self.corner = np.floor((low - _MARGIN_M) / cell_m).astype(np.int64)
        last = np.ceil((high + _MARGIN_M) / cell_m).astype(np.int64) - self.corner + 1
        shape = int(last[0]), int(last[1])
        nodes = np.argwhere(np.ones(shape, dtype=bool)) + self.corner
        xy = np.asarray(nodes * cell_m, dtype=np.float64)
        self.ground = built.ground.at(xy).reshape(shape)
        self.top, self.owner = self.ground.copy(), np.full(shape, -1)
        self.room = _room(built, xy).reshape(3, *shape)
        for number, one in enumerate(built.standing):
            T = one.T_map_stone
            self._add(number, raster_at(one.stone.vertices, one.stone.triangles, T, cell_m))
        self.near = _highest_within(self.top, _BESIDE_M / cell_m)
        self._heights = self.top - self.ground
        for one in built.around:
            T = one.T_map_stone
            self._bar(raster_at(one.stone.vertices, one.stone.triangles, T, cell_m))
        self.raised = _highest_within(self.top, astray_m / cell_m)

    def share_up_to(self, height_m: float) -> float:
        """Return which share of the inner half of the foot is built up to a height [m], 0 to 1."""
        inner = self.room.min(axis=0)
        core = inner >= inner.max() / 2
        return float((self._heights >= height_m)[core].mean())

    def _add(self, number: int, raster: StoneRaster) -> None:
        here, over = self._below(raster)
        is_higher = over > self.top[here]
        self.top[here][is_higher] = over[is_higher]
        self.owner[here][is_higher] = number

    def _bar(self, raster: StoneRaster) -> None:
        here, over = self._below(raster)
        self.top[here][np.isfinite(over)] = _BARRED_M

    def _below(self, raster: StoneRaster) -> tuple[tuple[slice, slice], Float]:
        """Return the nodes of the structure below a stone, and its upper side over them; none of
        one that lies beside the structure.
        """
        first = raster.first - self.corner
        low = np.minimum(np.maximum(first, 0), self.top.shape)
        high = np.maximum(np.minimum(first + raster.over.shape, self.top.shape), low)
        a, b = low - first, high - first
        here = slice(low[0], high[0]), slice(low[1], high[1])
        return here, raster.over[a[0] : b[0], a[1] : b[1]]


def _highest_within(top: Float, cells: float) -> Float:
    reach = np.arange(-int(cells + 1e-9), int(cells + 1e-9) + 1)
    is_near = np.hypot(reach[:, None], reach[None, :]) <= cells + 1e-9
    return np.asarray(maximum_filter(top, footprint=is_near, mode="nearest"))


def raster_at(vertices: Float, triangles: Int, T: Float, cell_m: float) -> StoneRaster:
    """Return the height maps of a stone at its pose: heights and nodes are those of the map."""
    points = vertices @ T[:3, :3].T + T[:3, 3]
    return raster_of(points, triangles, np.eye(3), cell_m)


def _room(built: AsBuilt, xy: Float) -> Float:
    structure = built.structure
    along, across = structure.along_across(xy)
    half = structure.thickness_m / 2
    is_endless = structure.is_ring or len(structure.line) == 1
    ends = np.full(len(xy), np.inf) if is_endless else np.minimum(along, structure.length_m - along)
    right = np.full(len(xy), np.inf) if len(structure.line) == 1 else half + across
    return np.stack([half - across, right, ends])
