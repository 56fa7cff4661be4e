"""Which points may be ground, by slope: no point lies far enough below one that is.

A point is ground if it is not higher above any other than the steepest ground would rise from there
(Vosselman 2000, "Slope based filtering of laser altimetry data"). The lowest heights are taken by
cells of a grid; cones of the steepest slope are set upon them.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from executive.arrays import Bool, Float, Int

_STRAY = 3.0  # margins under the lowest heights at which a point is a reflection, no ground
_BEHIND = ((-1, -1), (-1, 0), (-1, 1), (0, -1))  # the neighbours that a sweep has passed


@dataclass(frozen=True, slots=True)
class Relief:
    """Shares of the area that are steeper than ground.

    Attributes:
        rising: That rise from their surroundings.
        sinking: From which the surroundings rise.
    """

    rising: float
    sinking: float


@dataclass(frozen=True, slots=True, eq=False)
class LowerCone:
    """How high ground may be above the lowest heights, by cells of a grid.

    Single points below the ground, as of reflections, are none and lower no cone: the lowest
    heights are taken through a median over 3 × 3 cells.

    Attributes:
        cells: Cell of each point, shape (N, 2).
        lowest: Lowest height in each cell [m], inf for none, shape (nx, ny).
        tops: How high ground may be in each cell [m], shape (nx, ny).
    """

    cells: Int
    lowest: Float
    tops: Float

    @classmethod
    def under(cls, places: Float, heights: Float, cell_m: float, max_rise: float) -> "LowerCone":
        """Set cones upon the lowest heights.

        Args:
            places: Positions along the ground [m], shape (N, 2).
            heights: Above the ground's mean plane [m], shape (N,).
            cell_m: Grid edge [m].
            max_rise: Largest slope of the ground, as a tangent.
        """
        cells, lowest, tops = _lowest(places, heights, cell_m)
        _sweep(tops, max_rise * cell_m)
        _sweep(tops[::-1, ::-1], max_rise * cell_m)
        return cls(cells, lowest, tops)

    def may_be_ground(self, heights: Float, margin_m: float) -> Bool:
        """Return which points are not higher than ground can rise, shape (N,).

        Args:
            heights: Of the points that the cones were set under [m], shape (N,).
            margin_m: Height of ground above its lowest points [m].
        """
        above = heights - self.tops[self.cells[:, 0], self.cells[:, 1]]
        return np.asarray((above < margin_m) & (above > -_STRAY * margin_m))

    def steep_share(self, margin_m: float) -> float:
        """Return which share of the area is steeper than ground; margin as in `may_be_ground`."""
        seen = np.isfinite(self.lowest)
        return float((self.lowest[seen] > self.tops[seen] + margin_m).mean())


@njit(cache=True)  # type: ignore[untyped-decorator]
def _lowest(places: Float, heights: Float, cell_m: float) -> tuple[Int, Float, Float]:
    """Return the cell of each point, the lowest height in each cell, inf for none, and its median
    over 3 × 3 cells, of which those beyond the border are as the border.
    """
    low_x, low_y = places[:, 0].min(), places[:, 1].min()
    cells, shape = np.empty((len(places), 2), dtype=np.int64), np.zeros(2, dtype=np.int64)
    for n in range(len(cells)):
        i, j = int((places[n, 0] - low_x) / cell_m), int((places[n, 1] - low_y) / cell_m)
        cells[n, 0], cells[n, 1] = i, j
        shape[0], shape[1] = max(shape[0], i + 1), max(shape[1], j + 1)
    lowest, medians = np.full((shape[0], shape[1]), np.inf), np.empty((shape[0], shape[1]))
    for n in range(len(cells)):
        i, j = cells[n, 0], cells[n, 1]
        lowest[i, j] = min(lowest[i, j], heights[n])
    nine = np.empty(9)
    for i in range(shape[0]):
        for j in range(shape[1]):
            for a in range(3):
                for b in range(3):
                    value = lowest[
                        min(max(i + a - 1, 0), shape[0] - 1), min(max(j + b - 1, 0), shape[1] - 1)
                    ]
                    k = 3 * a + b  # sorted as they come
                    while k > 0 and nine[k - 1] > value:
                        nine[k] = nine[k - 1]
                        k -= 1
                    nine[k] = value
            medians[i, j] = nine[4]
    return cells, lowest, medians


@njit(cache=True)  # type: ignore[untyped-decorator]
def _sweep(cone: Float, rise_m: float) -> None:
    """Lower each cell to what the cells before it allow, in place; twice, once a direction."""
    for i in range(cone.shape[0]):
        for j in range(cone.shape[1]):
            for a, b in _BEHIND:
                if 0 <= i + a < cone.shape[0] and 0 <= j + b < cone.shape[1]:
                    step = rise_m * np.sqrt(float(a * a + b * b))
                    cone[i, j] = min(cone[i, j], cone[i + a, j + b] + step)
