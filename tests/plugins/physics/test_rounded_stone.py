"""Rounded stones: of the volume asked for, longest along x, the same from a seed, and without a
large flat face.
"""

import numpy as np
import pytest
from executive_plugins.physics.quarried_block import block
from executive_plugins.physics.rounded_stone import rounded_stone
from scipy.spatial import ConvexHull

from executive.arrays import Float


def largest_face(corners: Float) -> float:
    """Return the largest part of the surface that faces one way to 8°."""
    hull = ConvexHull(corners)
    sides = corners[hull.simplices]
    areas = (
        np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1) / 2
    )
    normals = hull.equations[:, :3]
    return float(
        max(areas[normals @ n > np.cos(np.radians(8))].sum() for n in normals) / areas.sum()
    )


@pytest.mark.parametrize("seed", range(5))
def test_the_stone_has_its_volume_and_its_axes_in_order(seed: int) -> None:
    corners = rounded_stone(0.4, np.random.default_rng(seed))
    assert ConvexHull(corners).volume == pytest.approx(0.4)
    extents = np.ptp(corners, axis=0)
    assert extents[0] >= extents[1] >= extents[2]
    np.testing.assert_array_equal(corners, rounded_stone(0.4, np.random.default_rng(seed)))


def test_it_has_no_face_as_large_as_a_blocks() -> None:
    rounded = [largest_face(rounded_stone(0.4, np.random.default_rng(i))) for i in range(10)]
    quarried = [largest_face(block(0.4, np.random.default_rng(i))) for i in range(10)]
    assert np.mean(rounded) < np.mean(quarried) / 2
