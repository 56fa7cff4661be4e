"""Releases under noise stand for its whole distribution, in a fixed number."""

import numpy as np
from executive_plugins.physics.trial import apart
from executive_plugins.placing.dry_stone.releases import releases
from scipy.stats import rayleigh

from executive.geometry.pose import pose


def rng() -> np.random.Generator:
    return np.random.default_rng(4)


def test_distances_are_those_of_normal_noise_the_farthest_first() -> None:
    found = releases(pose(), 400, 0.03, 0.0, rng())
    distances = np.array([np.linalg.norm(T[:2, 3]) for T in found])
    assert (np.diff(distances) < 0).all()
    shares = np.array([0.1, 0.5, 0.9])
    expected = rayleigh.ppf(shares, scale=0.03)
    np.testing.assert_allclose(np.quantile(distances, shares), expected, rtol=0.01)
    middle = np.mean([T[:3, 3] for T in found], axis=0)
    assert np.abs(middle).max() < 0.003  # headings on all sides: a tenth of the noise


def test_rotations_are_as_large_as_the_noise_about_three_axes() -> None:
    angles = [apart(pose(), T)[1] for T in releases(pose(), 400, 0.0, 0.03, rng())]
    rms = np.sqrt(np.mean(np.square(angles)))
    np.testing.assert_allclose(rms, 0.03 * np.sqrt(3), rtol=0.1)  # of 1200 draws


def test_eight_releases_of_3_cm_are_never_8_cm_off_before_they_are_let_go() -> None:
    for seed in range(20):
        found = releases(pose(), 8, 0.03, 0.035, np.random.default_rng(seed))
        assert max(apart(pose(), T)[0] for T in found) < 0.08


def test_no_noise_releases_at_the_pose_itself() -> None:
    T = pose(t=np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(releases(T, 2, 0.0, 0.0, rng()), [T, T])
