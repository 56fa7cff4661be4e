"""What stands around the machine: the map, and the stones that the database knows better."""

import numpy as np

from executive.behaviours.context import Context
from executive.geometry.pose import inverse, transform
from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold

_CELL_M = 0.03  # the map's own grid (Mascaro 2020, Table 3)


def surroundings(context: Context, without: int | None = None) -> Cloud:
    """Return the map merged with the object models (Sec. 5.2), at one density.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        without: Id of a stone whose model and map points are left out, such as the one that is held.
    """
    points = context.plugin("mapping").cloud().points
    stones = context.plugin("objects").stones()
    if without is not None:
        own = next(stone for stone in stones if stone.id == without)
        points = points[~_near(points, own.points_map)]
    models = [stone.points_map for stone in stones if stone.state.is_lying and stone.id != without]
    return Cloud("map", voxel_means(np.concatenate([points, *models]), _CELL_M))


def held_surface(context: Context, hold: Hold) -> np.ndarray:
    """Return the held stone's surface in the gripper's frame [m], shape (N, 3)."""
    stone = context.plugin("objects").stone(hold.stone_id)
    return transform(inverse(hold.T_map_gripper), stone.points_map)


def _near(points: np.ndarray, model: np.ndarray) -> np.ndarray:
    """Tell which points lie in the box of a stone's model, but for its lowest 10 cm, where the ground begins."""
    low, high = model.min(axis=0) - _CELL_M, model.max(axis=0) + _CELL_M
    low[2] += 0.1 + _CELL_M
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))
