"""The similarity from cameras to rough positions: exact without noise, unmoved by outliers, honest
about its scale.
"""

import numpy as np
import pytest
from executive_plugins.surveying.camera_alignment import CameraAlignment, align_cameras

from executive.errors import DataError
from executive.geometry.rigid_fit import similarity_fit
from executive.geometry.rotation import angle_between, exp_so3

SCALE, R, T = 2.5, exp_so3(np.array([0.3, -0.2, 2.0])), np.array([30.0, -12.0, 7.0])


def grid(rng: np.random.Generator) -> np.ndarray:
    """Return 36 cameras on a grid of 4 by 7 units, all nearly at one height, in a frame of their
    own.
    """
    x, y = np.meshgrid(np.linspace(-2, 2, 4), np.linspace(-3.5, 3.5, 9))
    return np.stack([x.ravel(), y.ravel(), rng.normal(0, 0.05, 36)], axis=1)


def positions(centres: np.ndarray) -> np.ndarray:
    return SCALE * centres @ R.T + T


def aligned(noise_m: float, outliers: int, seed: int = 0) -> CameraAlignment:
    rng = np.random.default_rng(seed)
    centres = grid(rng)
    rough = positions(centres) + rng.normal(0, noise_m, (36, 3))
    wrong = rng.permutation(36)[:outliers]
    rough[wrong] += rng.normal(0, 40, (outliers, 3))
    found = align_cameras(centres, rough, rng)
    assert not found.is_used[wrong].any()
    return found


def test_finds_a_similarity_exactly() -> None:
    found = aligned(0.0, 0)
    assert found.scale == pytest.approx(SCALE, rel=1e-12)
    assert np.allclose(found.R, R, atol=1e-12)
    assert np.allclose(found.t, T, atol=1e-10)
    assert found.is_used.all()
    points = np.random.default_rng(1).normal(size=(5, 3))
    assert np.allclose(found.apply(points), positions(points))


def test_leaves_out_a_third_that_is_far_off() -> None:
    found = aligned(0.0, 12)
    assert found.is_used.sum() == 24
    assert found.scale == pytest.approx(SCALE, rel=1e-9)


def test_never_mirrors_the_scene() -> None:
    flat = np.random.default_rng(0).normal(size=(20, 3)) * [1, 1, 1e-9]
    _, turned, _ = similarity_fit(flat * [1, 1, -1], flat)
    assert np.linalg.det(turned) == pytest.approx(1)


def test_states_how_far_the_scale_may_be_off() -> None:
    """The scale's error over its stated deviation has a deviation of one, also with outliers."""
    for outliers in (0, 6):
        found = [aligned(0.5, outliers, seed) for seed in range(30)]
        ratios = np.array([(one.scale / SCALE - 1) / one.scale_error for one in found])
        # 30 draws give a deviation to 13 %; trimming at 2.5 deviations makes the stated one a
        # little small.
        assert 0.7 < ratios.std() < 1.4
        tilts = [angle_between(one.R, R) for one in found]
        assert np.median(tilts) < np.radians(3)


def test_keeps_nearly_all_of_what_is_only_noisy() -> None:
    used = [aligned(1.0, 0, seed).is_used.mean() for seed in range(10)]
    assert np.mean(used) > 0.85


@pytest.mark.parametrize(
    ("centres", "words"),
    [
        (np.linspace(0, 9, 12)[:, None] * [1.0, 2.0, 0.0], "along one line"),
        (np.eye(3), "3 pictures with a place"),
    ],
)
def test_refuses_what_leaves_the_map_free_to_turn(centres: np.ndarray, words: str) -> None:
    with pytest.raises(DataError, match=words):
        align_cameras(centres, positions(centres), np.random.default_rng(0))
