"""What stands around the machine: the map, and the stones that the database knows better."""

import numpy as np

from executive.geometry.pose import inverse, transform
from executive.geometry.voxels import voxel_means
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold

_CELL_M = 0.03  # the map's own grid (Mascaro 2020, Table 3)
_MARGINS_M = (0.0, 0.5, 1.0, 1.5)  # about a stone: how far ground is looked for


def surroundings(context: Context, without: int | None = None) -> Cloud:
    """Return the map merged with the object models (Sec. 5.2), at one density.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        without: Id of a stone whose model and map points are left out, such as the one that is
            held.
    """
    points = context.use(Mapper).cloud().points
    stones = context.use(ObjectDatabase).stones()
    if without is not None:
        own = next(stone for stone in stones if stone.id == without)
        points = points[~_near(points, own.points_map)]
    models = [stone.points_map for stone in stones if stone.state.is_lying and stone.id != without]
    return Cloud("map", voxel_means(np.concatenate([points, *models]), _CELL_M))


def held_surface(context: Context, hold: Hold) -> np.ndarray:
    """Return the held stone's surface in the gripper's frame [m], shape (N, 3)."""
    stone = context.use(ObjectDatabase).stone(hold.stone_id)
    return transform(inverse(hold.T_map_gripper), stone.points_map)


def gap_below(stone: np.ndarray, points: np.ndarray) -> float:
    """Return the height [m] of a stone's lowest point above what is highest under it; negative if
    it reaches into it.

    Where the map shows nothing there, because it has forgotten the place that the stone was taken
    from, the middle height of what lies next to it stands for the ground; nothing within 1.5 m is
    no gap.
    """
    low, high = stone.min(axis=0), stone.max(axis=0)
    lower = points[points[:, 2] < high[2]]
    for margin_m in _MARGINS_M:
        is_under = (lower[:, :2] >= low[:2] - margin_m) & (lower[:, :2] <= high[:2] + margin_m)
        under = lower[is_under.all(axis=1), 2]
        if len(under):
            return float(low[2] - (under.max() if margin_m == 0.0 else np.median(under)))
    return 0.0


def _near(points: np.ndarray, model: np.ndarray) -> np.ndarray:
    """Tell which points lie in the box of a stone's model, but for its lowest 10 cm, where the
    ground begins.
    """
    low, high = model.min(axis=0) - _CELL_M, model.max(axis=0) + _CELL_M
    low[2] += 0.1 + _CELL_M
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))
