"""Where a stone comes to rest on height maps: it tilts until its centre of mass is lowest.

A stone that touches at one point tilts about it until others bear it. At rest its centre of mass is
as low as any small tilt can bring it, which is the condition that settling in physics finds after
hundreds of steps. Here it is a search over two angles, some milliseconds long, so that places at
which a stone would topple are left out before physics is asked (contacts first, as in Nadeau and
Kelly 2025).
"""

import numpy as np
from executive_plugins.placing.dry_stone.drops import rest_height
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop, raster_of

from executive.arrays import Float, Int
from executive.geometry.rotation import exp_so3
from executive.messages.solid_stone import SolidStone

_STEPS_RAD = (0.08, 0.04, 0.02)  # the last one shifts the rim of a stone of 1 m by a centimetre
_MOST_RAD = 0.35  # a stone that tilts farther than this comes to rest on another side
_LOWER_M = 2e-4  # a step that lowers the stone by less changes nothing
_WAYS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def at_rest(stone: SolidStone, R: Float, node: Int, wall: WallTop) -> StoneRaster | None:
    """Return the height maps of a stone in the tilt in which it rests, its origin over a node.

    Args:
        stone: The stone.
        R: Its rotation where it first touches, shape (3, 3).
        node: Node of the wall's grid that its origin stays over, from the wall's corner, (2,).
        wall: What it rests on.

    Returns:
        The turned stone; None if it tilts by more than 20°, or out of the grid.
    """
    tilt = np.zeros(2)
    best = _turned(stone, R, tilt, wall)
    lowest_m = _height_m(best, node, wall)
    for step_rad in _STEPS_RAD:
        while True:
            tried = [tilt + step_rad * way for way in _WAYS]
            rasters = [_turned(stone, R, one, wall) for one in tried]
            heights = [_height_m(one, node, wall) for one in rasters]
            k = int(np.argmin(heights))
            if not heights[k] < lowest_m - _LOWER_M:
                break
            tilt, best, lowest_m = tried[k], rasters[k], heights[k]
            if np.linalg.norm(tilt) > _MOST_RAD:
                return None
    return best if np.isfinite(lowest_m) else None


def _turned(stone: SolidStone, R: Float, tilt: Float, wall: WallTop) -> StoneRaster:
    turned = exp_so3(np.array([*tilt, 0.0])) @ R
    return raster_of(stone.vertices, stone.triangles, turned, wall.cell_m)


def _height_m(stone: StoneRaster, node: Int, wall: WallTop) -> float:
    """Return the height of the origin where the stone first touches, infinite off the grid [m]."""
    first = node + stone.first
    if (first < 1).any() or (first + stone.under.shape >= np.array(wall.top.shape) - 1).any():
        return float("inf")
    return float(rest_height(wall.top, stone.under, first[0], first[1]))
