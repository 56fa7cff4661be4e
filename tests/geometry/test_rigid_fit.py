"""Known motions are recovered, and the residual is the least."""

import numpy as np
import pytest

from executive.geometry.pose import pose, transform
from executive.geometry.rigid_fit import rigid_fit, similarity_fit
from executive.geometry.rotation import about_axis, exp_so3

RNG = np.random.default_rng(0)
POINTS = RNG.uniform(-5, 5, (20, 3))


@pytest.mark.parametrize("seed", range(5))
def test_a_known_similarity_is_recovered(seed: int) -> None:
    rng = np.random.default_rng(seed)
    R, t, scale = exp_so3(rng.normal(size=3)), rng.uniform(-50, 50, 3), rng.uniform(0.2, 5)
    found = similarity_fit(scale * POINTS @ R.T + t, POINTS)
    assert found[0] == pytest.approx(scale)
    np.testing.assert_allclose(found[1], R, atol=1e-12)
    np.testing.assert_allclose(found[2], t, atol=1e-10)


def test_a_rigid_fit_keeps_lengths_where_the_partners_are_larger() -> None:
    T = pose(exp_so3(np.array([0.4, -1.0, 2.0])), np.array([3.0, -4.0, 5.0]))
    centre = transform(T, POINTS).mean(axis=0)
    larger = centre + 1.3 * (transform(T, POINTS) - centre)
    np.testing.assert_allclose(rigid_fit(larger, POINTS), T, atol=1e-12)


def test_no_near_motion_fits_noisy_partners_better() -> None:
    partners = POINTS @ exp_so3(np.array([0.1, 0.2, -0.3])).T + RNG.normal(0, 0.2, POINTS.shape)

    def error(T: np.ndarray) -> float:
        return float(((transform(T, POINTS) - partners) ** 2).sum())

    best = rigid_fit(partners, POINTS)
    for axis in np.eye(3):
        for step in (-1e-3, 1e-3):
            assert error(pose(None, step * axis) @ best) > error(best)
            assert error(best @ pose(about_axis(axis, step))) > error(best)


def test_mirrored_partners_do_not_mirror_the_fit() -> None:
    mirrored = POINTS * [1, 1, -1]
    assert np.linalg.det(rigid_fit(mirrored, POINTS)[:3, :3]) == pytest.approx(1.0)
    assert np.linalg.det(similarity_fit(mirrored, POINTS)[1]) == pytest.approx(1.0)
