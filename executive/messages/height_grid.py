"""Heights over an even grid: the ground below a structure."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class HeightGrid:
    """Heights at the nodes of an even grid along x and y of the map.

    Attributes:
        corner: Place of the first node [m], shape (2,).
        cell_m: Distance of neighbouring nodes [m].
        heights: Height at node (i, j), at `corner + cell_m * (i, j)` [m], shape (I, J).
    """

    corner: Float
    cell_m: float
    heights: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "corner", checked("corner", self.corner, 2))
        object.__setattr__(self, "heights", checked("heights", self.heights, None, None))

    @classmethod
    def plane(
        cls, low: Float, high: Float, slope_rad: float = 0.0, heading_rad: float = 0.0
    ) -> "HeightGrid":
        """Return a plane over a box from above, through height 0 at the map's origin.

        Args:
            low: Corner of the box with the least x and y [m], shape (2,).
            high: The opposite corner [m], shape (2,).
            slope_rad: Its slope [rad].
            heading_rad: The direction in which it rises, from x towards y [rad].
        """
        cell_m = 0.25
        counts = np.ceil((np.asarray(high) - low) / cell_m).astype(int) + 1
        x, y = (low[k] + cell_m * np.arange(counts[k]) for k in (0, 1))
        uphill = x[:, None] * np.cos(heading_rad) + y[None, :] * np.sin(heading_rad)
        return cls(np.asarray(low, dtype=float), cell_m, np.tan(slope_rad) * uphill)

    def at(self, xy: Float) -> Float:
        """Return the heights at points (M, 2), between nodes bilinear, at the edge outside [m]."""
        most = np.array(self.heights.shape) - 1
        place = np.clip((xy - self.corner) / self.cell_m, 0.0, most)
        whole = np.minimum(place.astype(int), np.maximum(most - 1, 0))
        i, j = whole.T
        k, m = np.minimum(i + 1, most[0]), np.minimum(j + 1, most[1])
        u, v = (place - whole).T
        h = self.heights
        return np.asarray(
            (1 - u) * ((1 - v) * h[i, j] + v * h[i, m]) + u * ((1 - v) * h[k, j] + v * h[k, m])
        )
