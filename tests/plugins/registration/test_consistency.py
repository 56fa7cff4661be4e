"""Groups of matches that agree on one motion."""

import numpy as np
import pytest
from executive_plugins.registration.consistency import consistent_transforms

from executive.geometry.pose import pose, transform
from executive.geometry.rigid_fit import rigid_fit
from executive.geometry.rotation import angle_between, exp_so3


@pytest.mark.parametrize("seed", range(5))
def test_a_motion_is_found_among_nine_false_matches_in_ten(seed: int) -> None:
    rng = np.random.default_rng(seed)
    T = pose(exp_so3(rng.normal(0, 1, 3)), rng.normal(0, 5, 3))
    source = rng.uniform(-4, 4, (300, 3))
    target = rng.uniform(-6, 6, (300, 3))
    target[::10] = transform(T, source[::10]) * 1.005 + rng.normal(0, 0.02, (30, 3))
    found = consistent_transforms(target, source, 0.08, 0.03, 10)
    assert angle_between(found[0][:3, :3], T[:3, :3]) < np.radians(1)
    assert np.linalg.norm(transform(found[0], source[::10]) - target[::10], axis=1).mean() < 0.08


def test_two_motions_are_both_found() -> None:
    rng = np.random.default_rng(0)
    source = rng.uniform(-4, 4, (40, 3))
    motions = [
        pose(exp_so3(np.array([0, 0, angle])), np.array([angle, 0, 0])) for angle in (0.5, 2.0)
    ]
    target = np.vstack([transform(motions[0], source[:25]), transform(motions[1], source[25:])])
    found = consistent_transforms(target, source, 0.05, 0.0, 10)
    for motion, each in zip(motions, found[:2], strict=True):
        np.testing.assert_allclose(each, motion, atol=1e-6)


def test_few_matches_vote_for_nothing() -> None:
    assert consistent_transforms(np.zeros((3, 3)), np.zeros((3, 3)), 0.1, 0.0, 10).shape == (
        0,
        4,
        4,
    )
    rng = np.random.default_rng(0)
    lone = rng.uniform(-50, 50, (10, 3)), rng.uniform(-1, 1, (10, 3))
    assert consistent_transforms(*lone, 0.01, 0.0, 10).shape == (0, 4, 4)


def test_least_squares_beat_every_neighbour_and_never_mirror() -> None:
    rng = np.random.default_rng(1)
    source = rng.normal(size=(30, 3)) * [1, 1, 0.01]
    target = source * [1, 1, -1] + rng.normal(0, 0.1, (30, 3))
    T = rigid_fit(target, source)
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1)
    best = ((transform(T, source) - target) ** 2).sum()
    for _ in range(50):
        near = pose(exp_so3(rng.normal(0, 0.01, 3)), rng.normal(0, 0.01, 3)) @ T
        assert ((transform(near, source) - target) ** 2).sum() >= best
