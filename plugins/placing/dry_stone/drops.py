"""Every place for a stone in one orientation: where it comes to lie, and what it finds there.

The stone goes straight down until its underside touches the top of the structure. That is all of
the collision check: height maps do not see undercuts, so that no place below one is proposed.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop, raster_of
from numba import njit

from executive.arrays import Float, Int
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

# Columns of what is measured at a place.
HEIGHT, CONTACT, VOID, MARGIN, SHARE, OUTSIDE, DEPTH, TOP, BESIDE, RISE = range(10)
_COLUMNS = 10
_DIRECTIONS = 8  # in which the support margin is measured
_REHEARSED_CELL_M = 0.25  # any: a tetrahedron of a metre and a wall of two have nodes then
_BESIDE = 0.35  # share of the stone's height up to which a neighbour must reach to be beside it


@dataclass(frozen=True, slots=True)
class DropRules:
    """What counts as touching and as being in the envelope.

    Attributes:
        touch_m: Gap up to which stone and support count as touching [m].
        tan_left: Lean of the left face, as a tangent.
        tan_right: Lean of the right face, as a tangent.
        stride: Places are this many nodes apart.
        most_outside: Share of the stone off the foot of the envelope from which a place is not
            measured: it is given the share 1 and an infinite height of its top.
        highest_m: Height of the stone's top above the ground from which it is not measured [m].
        most_rise_m: Rise, see `drops`, from which it is not measured [m].
    """

    touch_m: float
    tan_left: float
    tan_right: float
    stride: int
    most_outside: float = 1.0
    highest_m: float = np.inf
    most_rise_m: float = np.inf


def drops(wall: WallTop, stone: StoneRaster, rules: DropRules) -> tuple[Int, Float]:
    """Return the places whose origin is over the foot of the envelope, and what is found there.

    Returns:
        Node of the stone's origin relative to the wall's corner, shape (P, 2), and its
        measurements, shape (P, 10): height of the origin, share of the underside that touches, mean
        gap below it, distance by which the centre of mass is within its support, largest share of
        the contact that belongs to one stone (1 on the ground), share outside the envelope, least
        depth in it, height of the top above the ground, share of the rim with a neighbour beside,
        and by how much it comes to lie higher where it is let go a little beside the place.
    """
    inside = (wall.room > 0).all(axis=0)
    places = np.argwhere(inside)
    on_grid = (places % rules.stride == 0).all(axis=1)
    places = places[on_grid]
    last = np.array(wall.top.shape) - stone.under.shape
    first = places + stone.first
    places = places[(first >= 1).all(axis=1) & (first < last - 1).all(axis=1)]
    return places, measured_at(places, wall, stone, rules)


def measured_at(places: Int, wall: WallTop, stone: StoneRaster, rules: DropRules) -> Float:
    """Return what is found at places (P, 2), nodes of the stone's origin, as `drops` does."""
    found = np.empty((len(places), _COLUMNS))
    if len(places):
        _measure(
            np.stack([wall.top, wall.raised, wall.near]),
            wall.owner,
            wall.ground,
            wall.room,
            wall.cell_m,
            stone.under,
            stone.over,
            stone.first,
            places,
            np.array([
                rules.touch_m, rules.tan_left, rules.tan_right, rules.most_outside, rules.highest_m,
                rules.most_rise_m,
            ]),
            found,
        )  # fmt: skip
    return found


def compile_drops() -> None:
    """Compile the inner loops, so that no search has to wait for them."""
    corners = np.vstack([np.zeros(3), np.eye(3)])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    stone = SolidStone.of_mesh("rehearsal", corners, triangles, 1.0)
    ground = HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0))
    line = np.array([[-1.0, 0.0], [1.0, 0.0]])
    wall = WallTop(AsBuilt(Structure("rehearsal", line, 1.0, 1.0), ground), _REHEARSED_CELL_M)
    raster = raster_of(stone.vertices, stone.triangles, np.eye(3), _REHEARSED_CELL_M)
    drops(wall, raster, DropRules(0.0, 0.0, 0.0, 1))


@njit(cache=True)
def _measure(tops, owner, ground, room, cell, under, over, first, places, rules, found):  # type: ignore[no-untyped-def]  # noqa: PLR0913 - compiled: no classes
    count = np.zeros(int(owner.max()) + 2)
    highest, top, thickest = rules[4] + ground.max(), tops[0], over.max()
    reach, ways = np.zeros(_DIRECTIONS), _ways()
    foot = np.minimum(np.minimum(room[0], room[1]), room[2])
    most_off = rules[3] * (under < np.inf).sum()
    for p in range(len(places)):
        x, y = places[p, 0] + first[0], places[p, 1] + first[1]
        z, rise = np.inf, np.inf
        if not _is_off_foot(foot, under, x, y, most_off):
            z = _rest_below(top, under, x, y, thickest, highest)
        if z < np.inf:
            # The highest of all heights at which it rests around here: maxima can be exchanged.
            rise = _rest_below(tops[1], under, x, y, -z, rules[5]) - z
        if rise == np.inf:
            found[p] = 0.0
            found[p, OUTSIDE], found[p, TOP] = 1.0, np.inf
            continue
        count[:], reach[:] = 0.0, -np.inf
        cells, touching, gaps, outside = 0, 0, 0.0, 0
        depth, tallest = np.inf, -np.inf
        for i in range(under.shape[0]):
            for j in range(under.shape[1]):
                if under[i, j] == np.inf:
                    continue
                cells += 1
                gap = z + under[i, j] - top[x + i, y + j]
                gaps += gap
                if gap <= rules[0]:
                    touching += 1
                    count[owner[x + i, y + j] + 1] += 1.0
                    _reach(reach, ways, (i + first[0]) * cell, (j + first[1]) * cell)
                base = ground[x + i, y + j]
                above = max(0.0, z + 0.5 * (under[i, j] + over[i, j]) - base)
                left = room[0, x + i, y + j] - rules[1] * above
                right = room[1, x + i, y + j] - rules[2] * above
                inner = min(left, right, room[2, x + i, y + j])
                depth = min(depth, inner)
                outside += inner < 0
                tallest = max(tallest, z + over[i, j] - base)
        on_stones = count[1:].sum()
        found[p, HEIGHT], found[p, CONTACT] = z, touching / cells
        found[p, VOID], found[p, MARGIN] = gaps / cells, reach.min()
        found[p, SHARE] = 1.0 if on_stones < count[0] else count[1:].max() / on_stones
        found[p, OUTSIDE], found[p, DEPTH], found[p, TOP] = outside / cells, depth, tallest
        found[p, BESIDE], found[p, RISE] = _beside(tops[2], under, over, x, y, z), rise


@njit(cache=True)
def _is_off_foot(foot, under, x, y, most):  # type: ignore[no-untyped-def]
    """Return whether more nodes of the stone than `most` are off the foot of the envelope.

    A face that leans inwards leaves less room higher up, so no place that fits is lost.
    """
    outside = 0
    for i in range(under.shape[0]):
        for j in range(under.shape[1]):
            if under[i, j] < np.inf and foot[x + i, y + j] < 0:
                outside += 1
        if outside > most:
            return True
    return False


@njit(cache=True)
def _rest_below(top, under, x, y, added, most):  # type: ignore[no-untyped-def]
    """Return the height of the origin at which the underside first touches.

    It is infinite as soon as it and `added` are over `most`.
    """
    z = -np.inf
    for i in range(under.shape[0]):
        for j in range(under.shape[1]):
            if under[i, j] < np.inf:
                z = max(z, top[x + i, y + j] - under[i, j])
        if z + added > most:
            return np.inf
    return z


@njit(cache=True)
def _ways():  # type: ignore[no-untyped-def]
    """Return the directions of the support margin, unit vectors (D, 2)."""
    ways = np.zeros((_DIRECTIONS, 2))
    for d in range(_DIRECTIONS):
        angle = 2 * np.pi * d / _DIRECTIONS
        ways[d] = np.cos(angle), np.sin(angle)
    return ways


@njit(cache=True)
def _reach(reach, ways, dx, dy):  # type: ignore[no-untyped-def]
    """Raise how far the contact reaches in each direction from below the centre of mass."""
    for d in range(len(ways)):
        reach[d] = max(reach[d], dx * ways[d, 0] + dy * ways[d, 1])


@njit(cache=True)
def _beside(top, under, over, x, y, z):  # type: ignore[no-untyped-def]
    """Return the share of the nodes just off the stone that something stands beside."""
    low, high = np.inf, -np.inf
    for i in range(under.shape[0]):
        for j in range(under.shape[1]):
            if under[i, j] < np.inf:
                low, high = min(low, under[i, j]), max(high, over[i, j])
    level = z + low + _BESIDE * (high - low)
    rim, beside = 0, 0
    for i in range(-1, under.shape[0] + 1):
        for j in range(-1, under.shape[1] + 1):
            if _is_on(under, i, j):
                continue
            if (
                _is_on(under, i - 1, j)
                or _is_on(under, i + 1, j)
                or _is_on(under, i, j - 1)
                or _is_on(under, i, j + 1)
            ):
                rim += 1
                beside += top[x + i, y + j] > level
    return beside / max(1, rim)


@njit(cache=True)
def _is_on(under, i, j):  # type: ignore[no-untyped-def]
    return 0 <= i < under.shape[0] and 0 <= j < under.shape[1] and under[i, j] < np.inf
