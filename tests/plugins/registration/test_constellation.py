"""Motions guessed from where stones stand."""

import numpy as np
import pytest
from executive_plugins.registration.constellation import constellation_transforms

from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, from_rpy

LEVEL = np.array([0.0, 0.0, 1.0, 0.0])


def seen_from(T: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Express centroids and the level ground in another frame."""
    T_there = inverse(T)
    normal = T_there[:3, 2]
    return transform(T_there, points), np.array([*normal, normal @ T_there[:3, 3]])


@pytest.mark.parametrize("seed", range(8))
def test_the_true_motion_is_among_the_first_although_centroids_are_off_and_stones_missing(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    stones = np.column_stack([rng.uniform(-5, 5, (7, 2)), np.full(7, 0.4)])
    T = pose(from_rpy(*rng.normal(0, 0.05, 2), rng.uniform(-3, 3)), rng.uniform(-20, 20, 3))
    seen = stones[:6] + rng.normal(0, 0.1, (6, 3))  # half-seen stones
    found = constellation_transforms((seen, LEVEL), seen_from(T, stones[1:]), 0.5, 1.0, 10)
    turns = [angle_between(each[:3, :3], T[:3, :3]) for each in found]
    best = int(np.argmin(turns))
    assert turns[best] < np.radians(6)
    moved = transform(found[best], seen_from(T, stones)[0])
    assert np.linalg.norm(moved - stones, axis=1).mean() < 0.35


def test_motions_keep_the_grounds_on_each_other() -> None:
    rng = np.random.default_rng(0)
    stones = np.column_stack([rng.uniform(-5, 5, (4, 2)), rng.uniform(0.3, 0.6, 4)])
    T = pose(from_rpy(0.1, -0.15, 2.0), np.array([3.0, 4.0, 5.0]))
    source = seen_from(T, stones)
    for found in constellation_transforms((stones, LEVEL), source, 0.5, 1.0, 10):
        np.testing.assert_allclose(found[:3, :3] @ source[1][:3], [0, 0, 1], atol=1e-9)
        np.testing.assert_allclose(transform(found, source[1][:3] * source[1][3])[2], 0, atol=1e-9)


def test_one_stone_is_no_constellation() -> None:
    one = (np.zeros((1, 3)), LEVEL)
    assert constellation_transforms(one, one, 0.5, 1.0, 10).shape == (0, 4, 4)


def test_the_best_motion_is_the_planar_fit_of_all_stones_that_support_it() -> None:
    """A motion from two stones alone would carry all of their error.

    The expected motion is the least-squares fit of complex numbers t = a s + b with |a| = 1.
    """
    rng = np.random.default_rng(3)
    seen = np.column_stack([rng.uniform(-5, 5, (6, 2)), np.full(6, 0.4)])
    T = pose(from_rpy(0, 0, 1.2), np.array([7.0, -3.0, 0.0]))
    source = transform(inverse(T), seen) + rng.normal(0, 0.1, (6, 3)) * [1, 1, 0]
    found = constellation_transforms((seen, LEVEL), (source, LEVEL), 0.5, 1.0, 10)[0]
    t, s = (x[:, 0] + 1j * x[:, 1] for x in (seen, source))
    a = np.vdot(s - s.mean(), t - t.mean())
    a /= abs(a)
    b = t.mean() - a * s.mean()
    np.testing.assert_allclose(found[:2, 0], [a.real, a.imag], atol=1e-9)
    np.testing.assert_allclose(found[:2, 3], [b.real, b.imag], atol=1e-9)
    np.testing.assert_allclose(found[2], [0, 0, 1, 0], atol=1e-9)
