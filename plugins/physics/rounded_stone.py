"""Convex stones rounded by ice and water: no faces, no edges, a few broad bulges.

They complement quarried blocks, so that a model that is trained on generated stones does not rely
on flat faces. The axes follow the same statistics of found stones.
"""

import numpy as np
from executive_plugins.physics.even_directions import even_directions
from executive_plugins.physics.quarried_block import ratios
from scipy.spatial import ConvexHull

from executive.arrays import Float

_CORNERS = 90
_BULGES = (4, 9)  # number of bulges: least, and largest plus one
_HEIGHT = 0.12  # standard deviation of the heights of bulges, over the radius
_BREADTH = (2.0, 6.0)  # concentration of a bulge around its direction: 2 covers a side, 6 a corner


def rounded_stone(volume_m3: float, rng: np.random.Generator) -> Float:
    """Draw the corners of a convex stone of a volume, around the middle of its box, (V, 3) [m].

    Its extents a ≥ b ≥ c are along x, y, z.
    """
    b_a, c_b = ratios(rng)
    corners = _bulged(even_directions(_CORNERS), rng)
    corners = corners[ConvexHull(corners).vertices]
    corners = (corners - corners.min(axis=0)) / np.ptp(corners, axis=0) - 0.5
    corners = corners * np.array([1.0, b_a, b_a * c_b])
    return np.asarray(corners * np.cbrt(volume_m3 / ConvexHull(corners).volume))


def _bulged(directions: Float, rng: np.random.Generator) -> Float:
    """Scale the unit vectors by the bulges around random directions."""
    radius = np.ones(len(directions))
    for _ in range(int(rng.integers(*_BULGES))):
        middle = rng.normal(size=3)
        middle /= np.linalg.norm(middle)
        radius += rng.normal(0.0, _HEIGHT) * np.exp(
            rng.uniform(*_BREADTH) * (directions @ middle - 1.0)
        )
    return np.asarray(directions * radius[:, None])
