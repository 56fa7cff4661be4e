"""How firmly a stone will stand at a place, told from height maps in a millisecond.

The stone rolls to rest where it is let go, and again from where noise may let it go. A place at
which these rests differ is one at which a release is left to chance. Physics tells the same, in a
hundred times the time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.placing.dry_stone.rasters import WallTop
from executive_plugins.placing.dry_stone.releases import releases
from executive_plugins.placing.dry_stone.rolling import STEPS_RAD, roll
from executive_plugins.placing.dry_stone.settings import CheckSettings

from executive.arrays import Float

_MOST_RAD = 0.5  # a stone that tilts farther comes to rest on another side
_LOST_RAD = 0.7  # what it then counts as having turned
_ROUGH_RAD = STEPS_RAD[:2]  # steps under noise: a difference of rests below 1° is none
# Share of places that pass all checks, by the tilt and the mean turn of their stones [1/rad]:
# logistic regression over 599 places, 105 of which held, of the walls of 62401, 62403 and 62414
# with what a mission knows (docs/evidence/walls.md). Left out in turn, each wall as it stood is
# told by the others with an area of 0.81 below the curve; contact, support margin and interlock
# beside these two add nothing.
_CHANCE, _PER_TILT, _PER_TURN = 1.44, -23.0, -43.0


@dataclass(frozen=True, slots=True)
class Footing:
    """How a stone stands at a place.

    Attributes:
        tilt_rad: By how much it tilts from the attitude of the place until it rests.
        turned_rad: By how much more or less under noise, the mean of all releases.
    """

    tilt_rad: float
    turned_rad: float

    @property
    def chance(self) -> float:
        """Return the chance that the place passes all checks, 0 to 1."""
        odds = _CHANCE + _PER_TILT * self.tilt_rad + _PER_TURN * self.turned_rad
        return float(1.0 / (1.0 + np.exp(-odds)))


class Noise:
    """What noise does to a release: offsets of place and tilt that stand for all."""

    def __init__(self, check: CheckSettings) -> None:
        """Spread as many releases as the check makes, by its noise; the same at all places."""
        rng = np.random.default_rng(0)
        drawn = releases(np.eye(4), check.samples, check.noise, check.tilt_noise, rng)
        # A small rotation is its rotation vector: half of what is not symmetric in the matrix.
        self.offsets: Sequence[tuple[Float, Float]] = [
            (T[:2, 3], np.array([T[2, 1] - T[1, 2], T[0, 2] - T[2, 0]]) / 2) for T in drawn
        ]


def footing(underside: Float, wall: WallTop, xy: Float, noise: Noise, most_rad: float) -> Footing:
    """Return how a stone stands whose origin is let go over a point.

    Args:
        underside: Points of its underside from its origin, shape (N, 3) [m].
        wall: What it stands on.
        xy: Where its origin is, shape (2,) [m].
        noise: What may happen to the release.
        most_rad: A stone that tilts farther than this is not let go under noise as well: it is told
            as lost.
    """
    rest = roll(underside, wall, xy, np.zeros(2), _MOST_RAD)
    tilt_rad = float(np.linalg.norm(rest.tilt)) if rest.is_at_rest else _LOST_RAD
    if tilt_rad > most_rad:
        return Footing(tilt_rad, _LOST_RAD)
    turned = []
    for offset, leaned in noise.offsets:
        found = roll(underside, wall, rest.xy + offset, rest.tilt + leaned, _MOST_RAD, _ROUGH_RAD)
        apart_rad = float(np.linalg.norm(found.tilt - rest.tilt))
        turned.append(apart_rad if found.is_at_rest else _LOST_RAD)
    return Footing(tilt_rad, float(np.mean(turned)))
