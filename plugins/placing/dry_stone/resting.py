"""Where a stone comes to rest on height maps, and the height maps of the stone as it lies there.

Settling in physics finds the same rest after hundreds of steps. Here places at which a stone would
topple are left out before physics is asked (contacts first, as in Nadeau and Kelly 2025).
"""

import numpy as np
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop, raster_of
from executive_plugins.placing.dry_stone.rolling import roll, underside_of

from executive.arrays import Float, Int
from executive.geometry.rotation import exp_so3
from executive.messages.solid_stone import SolidStone


def at_rest(
    stone: SolidStone, R: Float, node: Int, wall: WallTop, most_rad: float
) -> tuple[StoneRaster, Int] | None:
    """Return the height maps of a stone as it rests, and the node that its origin is over then.

    Args:
        stone: The stone.
        R: Its rotation where it first touches, shape (3, 3).
        node: Node of the wall's grid that its origin is over there, from the wall's corner, (2,).
        wall: What it rests on.
        most_rad: Tilt beyond which it is left out.

    Returns:
        The turned stone and its node (2,); None if it tilts farther, or lies off the grid.
    """
    underside = underside_of(
        raster_of(stone.vertices, stone.triangles, R, wall.cell_m), wall.cell_m
    )
    xy = np.asarray((node + wall.corner) * wall.cell_m, dtype=np.float64)
    rest = roll(underside, wall, xy, np.zeros(2), most_rad)
    if not rest.is_at_rest:
        return None
    turned = exp_so3(np.array([*rest.tilt, 0.0])) @ R
    raster = raster_of(stone.vertices, stone.triangles, turned, wall.cell_m)
    there = np.rint(rest.xy / wall.cell_m).astype(np.int64) - wall.corner
    first, size = there + raster.first, np.array(wall.top.shape)
    is_on = (first >= 1).all() and (first + raster.under.shape < size - 1).all()
    return (raster, there) if is_on else None
