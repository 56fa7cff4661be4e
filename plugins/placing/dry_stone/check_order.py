"""The order in which places are checked: the best first, but later where others did not hold.

Ranked by their score alone, almost all of the first places of a dozen stones may be one gap between
domed tops, in which none of them holds.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.placing.dry_stone.parts import Place

from executive.arrays import Float

_NEAR_M = 0.25  # standard deviation of the doubt that a place casts around itself


class CheckOrder:
    """Yields places, best first; what fails meanwhile changes what comes next."""

    def __init__(self, places: Sequence[Place], failed: Sequence[Float], doubt: float) -> None:
        """Take the places of a lot of stones.

        Args:
            places: The places, best first.
            failed: Where a stone did not hold so far, from above [m], (2,) each.
            doubt: What is taken off the score of another stone at such a place.
        """
        self._places, self._doubt = places, doubt
        self._at = np.array([one.T_map_stone[:2, 3] for one in places]).reshape(-1, 2)
        self._scores = np.array([one.score for one in places])
        for xy in failed:
            self.fail_at(xy)

    def __iter__(self) -> Iterator[Place]:
        for _ in self._places:
            best = int(self._scores.argmax())  # of equal ones the first
            self._scores[best] = -np.inf
            yield self._places[best]

    def fail_at(self, xy: Float) -> None:
        """Have places near one, (2,) [m], come later: a stone did not hold there."""
        apart = ((self._at - xy) ** 2).sum(axis=1) / _NEAR_M**2
        self._scores -= self._doubt * np.exp(-apart / 2)
