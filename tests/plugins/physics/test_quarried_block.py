"""Quarried blocks: the spread of their faces, and the direction and depth of their cuts."""

from itertools import product

import numpy as np
import pytest
from executive_plugins.physics.quarried_block import _blows, _partings

from executive.arrays import Float


def draws(count: int = 400) -> Float:
    """Return the unit normals of the six faces of many blocks, shape (count, 3, 2, 3)."""
    planes = [_partings(np.random.default_rng(seed)) for seed in range(count)]
    np.testing.assert_array_equal(np.array(planes)[:, :, 3], -1.0)
    return np.array(planes)[:, :, :3].reshape(count, 3, 2, 3)


@pytest.mark.parametrize(("axis", "tilt_rad"), [(0, 0.12), (1, 0.12), (2, 0.05)])
def test_faces_scatter_about_the_axes_by_the_tilt_of_their_kind(axis: int, tilt_rad: float) -> None:
    normals = draws()[:, axis]
    assert (normals[:, 0, axis] < -0.8).all()
    assert (normals[:, 1, axis] > 0.8).all()
    across = np.delete(normals, axis, axis=2)
    # 400 draws: the mean is known to 5 % of the tilt, its spread to 3 %.
    assert np.abs(across.mean(axis=0)).max() < 0.2 * tilt_rad
    assert across.std() == pytest.approx(tilt_rad, rel=0.12)


def test_blows_cut_corners_and_edges_at_their_depth() -> None:
    towards = np.array([v for v in product((-1.0, 0.0, 1.0), repeat=3) if any(v)])
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    angles, depths = [], []
    for seed in range(200):
        planes = _blows(np.random.default_rng(seed))
        assert 6 <= len(planes) <= 12
        angles.append(np.arccos(np.clip((planes[:, :3] @ towards.T).max(axis=1), -1, 1)))
        depths.append(-planes[:, 3] / np.abs(planes[:, :3]).sum(axis=1))
    assert 0.68 <= np.concatenate(depths).min() < 0.70
    assert 0.90 < np.concatenate(depths).max() <= 0.92
    # Random directions would deviate from the nearest of the 26 by 0.25 rad on average.
    assert np.concatenate(angles).mean() < 0.2
