"""Ground that is seen below a part: what rests on the ground hides the ground under it."""

from collections.abc import Callable

import numpy as np
from numba import njit

from executive.arrays import Float, Int


class SeenGround:
    """The places where a cloud shows ground.

    Args:
        find_places: Returns positions of the ground's points along it [m], shape (M, 2); called
            once, and only if they are asked for.
        cell_m: Grid edge of the view from above [m].
    """

    def __init__(self, find_places: Callable[[], Float], cell_m: float) -> None:
        self._find_places, self._cell_m = find_places, cell_m
        self._places: Float | None = None

    def share_below(self, places: Float) -> float:
        """Return the share of a part's area below which ground is seen.

        Args:
            places: Positions of the part's points along the ground [m], shape (N, 2), N ≥ 1.
        """
        if self._places is None:
            self._places = np.ascontiguousarray(self._find_places())
        low = places.min(axis=0)
        cells = ((places - low) / self._cell_m).astype(np.int64)
        spans = cells.max(axis=0) + 1
        is_seen = _seen(self._places, low, spans, self._cell_m)
        covered = np.unique(cells[:, 0] * spans[1] + cells[:, 1])
        return float(is_seen[covered].mean())


@njit(cache=True)  # type: ignore[untyped-decorator]
def _seen(places: Float, low: Float, spans: Int, cell_m: float) -> Int:
    """Return which cells of a rectangle hold a place, 0 or 1, shape (spans[0] spans[1],)."""
    seen = np.zeros(spans[0] * spans[1], dtype=np.int64)
    for n in range(len(places)):
        i = int(np.floor((places[n, 0] - low[0]) / cell_m))
        j = int(np.floor((places[n, 1] - low[1]) / cell_m))
        if 0 <= i < spans[0] and 0 <= j < spans[1]:
            seen[i * spans[1] + j] = 1
    return seen
