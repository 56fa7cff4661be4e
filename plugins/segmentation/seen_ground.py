"""Ground that is seen below a part: what rests on the ground hides the ground under it."""

import numpy as np
from numba import njit

from executive.arrays import Float, Int, read_only


class SeenGround:
    """The places where a cloud shows ground.

    Args:
        points: The ground's points [m], shape (M, 3).
        centre: Where places along the ground are measured from [m], shape (3,).
        axes: Directions along the ground, shape (3, 2).
        cell_m: Grid edge of the view from above [m].
    """

    def __init__(self, points: Float, centre: Float, axes: Float, cell_m: float) -> None:
        self._ground = read_only(points), read_only(centre), read_only(np.ascontiguousarray(axes))
        self._cell_m = cell_m

    def share_below(self, places: Float) -> float:
        """Return the share of a part's area below which ground is seen.

        Args:
            places: Positions of the part's points along the ground [m], shape (N, 2), N ≥ 1.
        """
        low = places.min(axis=0)
        cells = ((places - low) / self._cell_m).astype(np.int64)
        spans = cells.max(axis=0) + 1
        is_seen = _seen(*self._ground, low, spans, self._cell_m)
        covered = np.unique(cells[:, 0] * spans[1] + cells[:, 1])
        return float(is_seen[covered].mean())


@njit(cache=True)  # type: ignore[untyped-decorator]
def _seen(points: Float, centre: Float, axes: Float, low: Float, spans: Int, cell_m: float) -> Int:
    """Return which cells of a rectangle hold a point, 0 or 1, shape (spans[0] spans[1],).

    The points of a wide site are not copied for that: their places alone would be half as large.
    """
    seen = np.zeros(spans[0] * spans[1], dtype=np.int64)
    for n in range(len(points)):
        x, y, z = points[n, 0] - centre[0], points[n, 1] - centre[1], points[n, 2] - centre[2]
        along = x * axes[0, 0] + y * axes[1, 0] + z * axes[2, 0]
        beside = x * axes[0, 1] + y * axes[1, 1] + z * axes[2, 1]
        i = int(np.floor((along - low[0]) / cell_m))
        j = int(np.floor((beside - low[1]) / cell_m))
        if 0 <= i < spans[0] and 0 <= j < spans[1]:
            seen[i * spans[1] + j] = 1
    return seen
