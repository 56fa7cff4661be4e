"""Scans of the last seconds, to tell what came into a place that they saw to be empty."""

from collections import deque
from collections.abc import Sequence

import numpy as np
from executive_plugins.mapping.range_image import RangeImage, passed_on_both_sides
from numba import njit

from executive.arrays import Bool, Float

_VIEWS = 4  # scan pairs that are kept, spread evenly over the last seconds
View = tuple[Float, RangeImage]  # position of a lidar [m], and what it saw from there


class EarlierViews:
    """Keeps some scan pairs of the last ones.

    Something that moves slowly is beside its next place just before it is there, and rays do not
    pass on both sides of that place: only older pairs show it to be empty.

    Args:
        pairs: Number of scan pairs over which the kept ones are spread.
        width_m: Largest distance of two rays between which a place is seen to be empty [m].
        margin_m: Distance behind a place at which a ray must end to have passed it [m].
    """

    def __init__(self, pairs: int, width_m: float, margin_m: float) -> None:
        self._every = max(pairs // _VIEWS, 1)
        self._lengths_m = width_m, margin_m
        self._kept: deque[Sequence[View]] = deque(maxlen=_VIEWS)

    def clear(self) -> None:
        """Forget all views."""
        self._kept.clear()

    def add(self, pair: int, views: Sequence[View]) -> None:
        """Keep the views of a scan pair, if it is its turn."""
        if pair % self._every == 0:
            self._kept.append(tuple(views))

    def saw_empty(self, places: Float) -> Bool:
        """Return which places a kept pair saw to be empty, (N, 3) → (N,)."""
        empty = np.zeros(len(places), dtype=np.bool_)
        for pair in self._kept:
            for origin, image in pair:
                _add_empty(empty, places, origin, image, *self._lengths_m)
        return empty


@njit(cache=True)  # type: ignore[untyped-decorator]
def _add_empty(
    empty: Bool, places: Float, origin: Float, image: RangeImage, width_m: float, margin_m: float
) -> None:  # pragma: no cover - compiled
    """Mark the places that a view saw to be empty."""
    for n in range(len(places)):
        if not empty[n]:
            empty[n] = passed_on_both_sides(image, origin, places[n], width_m, margin_m)
