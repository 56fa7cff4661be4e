"""Places of a map in which something moves."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, Int, checked

_BITS = 20  # of each index in a key: ±500,000 places


@dataclass(frozen=True, slots=True, eq=False)
class MovingPlaces:
    """Cubes that something came into a moment ago, or is leaving: what is there does not stand.

    Attributes:
        edge_m: Edge of a cube [m].
        cells: Index of each cube along the axes of the map, floor(p / edge), shape (N, 3).
    """

    edge_m: float
    cells: Int

    def __post_init__(self) -> None:
        object.__setattr__(self, "cells", checked("cells", self.cells, None, 3, dtype=np.int64))

    def hold(self, points_map: Float) -> Bool:
        """Return which points are in such a cube, (N, 3) → (N,)."""
        points = checked("points_map", points_map, None, 3)
        return np.isin(_keys(np.floor(points / self.edge_m).astype(np.int64)), _keys(self.cells))

    def share(self, points_map: Float) -> float:
        """Return the share of points in such a cube; 0 of none."""
        return float(self.hold(points_map).mean()) if len(points_map) else 0.0


def _keys(cells: Int) -> Int:
    offset = cells + (1 << (_BITS - 1))
    return (offset[:, 0] << 2 * _BITS) + (offset[:, 1] << _BITS) + offset[:, 2]
