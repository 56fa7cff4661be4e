"""Cuts between two bodies: what they are judged by, against the same without compiled loops."""

import numpy as np
import pytest
from executive_plugins.segmentation.two_bodies import (
    _different,
    _first_planes,
    _judged,
    axes_of,
    best_cut,
    depths_under_hulls,
    half_sphere,
)

from executive.arrays import Float

SHARE = 0.08  # of the patches beyond the outermost cut
BEST = 4  # cuts that are moved


def cloud(count: int, seed: int = 0) -> Float:
    return np.random.default_rng(seed).normal(size=(count, 3)) * [1.0, 0.6, 0.4]


def test_axes_to_all_sides_are_even_and_of_length_one() -> None:
    axes = half_sphere(20)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1.0)
    assert (axes[:, 2] > 0).all()
    # Of heights spread evenly, which have equal areas of a sphere.
    np.testing.assert_allclose(axes[:, 2], (np.arange(20) + 0.5) / 20)
    # Each is turned by the golden angle from the one before.
    azimuths = np.arctan2(axes[:, 1], axes[:, 0])
    golden = 2 * np.pi / ((1 + np.sqrt(5)) / 2) ** 2
    turns = np.diff(azimuths) % (2 * np.pi)
    np.testing.assert_allclose(np.minimum(turns, 2 * np.pi - turns), golden)


@pytest.mark.parametrize("count", [1, 5, 40])
def test_normals_that_differ_most_are_chosen_one_after_the_other(count: int) -> None:
    normals = cloud(40)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    kept = [0]
    while len(kept) < count:
        nearest = np.abs(normals @ normals[kept].T).max(axis=1)
        kept.append(int(nearest.argmin()))
    np.testing.assert_array_equal(_different(normals, count), normals[kept])
    assert len(_different(normals[:3], 9)) == 3


@pytest.mark.parametrize("seed", range(3))
def test_a_cut_is_judged_by_the_mean_depth_under_the_hulls_of_its_sides(seed: int) -> None:
    patches = cloud(60, seed)
    level = patches - patches.mean(axis=0)
    axes = half_sphere(12)
    along = level @ axes.T
    along = np.ascontiguousarray((along - along.min(axis=0)).astype(np.float32))
    planes = np.column_stack([half_sphere(19), np.linspace(-1.5, 1.5, 19)])
    found, expected = _judged(level, along, planes), np.full(19, np.inf)
    for number, plane in enumerate(planes):
        is_beyond = level @ plane[:3] > plane[3]
        if min(is_beyond.mean(), 1 - is_beyond.mean()) >= 0.9 * SHARE:
            expected[number] = depths_under_hulls(patches, axes, is_beyond).mean()
    is_told = np.isfinite(found)  # others are not among the best, and are given up
    np.testing.assert_allclose(found[is_told], expected[is_told], atol=1e-5)
    best = np.argsort(expected)[:BEST]
    assert is_told[best].all()
    np.testing.assert_array_equal(np.argsort(found)[:BEST], best)
    assert np.isfinite(expected).sum() > is_told.sum()


def test_depths_are_those_under_the_nearest_face_of_a_box() -> None:
    """Along the axes of a box, a place is as deep as its distance from the nearest face."""
    corners = np.array([[x, y, z] for x in (0, 4.0) for y in (0, 2.0) for z in (0, 1.0)])
    inside = np.array([[2.0, 1.0, 0.5], [0.3, 1.0, 0.5], [2.0, 1.9, 0.5], [2.0, 1.0, 0.8]])
    patches = np.vstack([corners, inside])
    one = depths_under_hulls(patches, np.eye(3), np.zeros(12, dtype=bool))
    np.testing.assert_allclose(one, [0.0] * 8 + [0.5, 0.3, 0.1, 0.2], atol=1e-12)
    # Two boxes, each with hulls of its own.
    both = np.vstack([patches, patches + [10.0, 0.0, 0.0]])
    two = depths_under_hulls(both, np.eye(3), np.arange(24) >= 12)
    np.testing.assert_allclose(two, np.tile(one, 2), atol=1e-12)


def test_first_cuts_leave_a_share_of_the_patches_on_either_side() -> None:
    level = cloud(400)
    planes = _first_planes(level)
    assert planes.shape == (24 * 7, 4)
    shares = (planes[:, :3] @ level.T > planes[:, 3:]).mean(axis=1).reshape(24, 7)
    np.testing.assert_allclose(shares[:, 0], 1 - SHARE, atol=0.01)
    np.testing.assert_allclose(shares[:, -1], SHARE, atol=0.01)
    steps = np.diff(planes[:, 3].reshape(24, 7), axis=1)
    np.testing.assert_allclose(steps, steps[:, :1] * np.ones(6))


def test_normals_of_a_flat_surface_are_across_it() -> None:
    xy = np.random.default_rng(0).uniform(-1, 1, (80, 2))
    axes = axes_of(np.column_stack([xy, np.zeros(80)]))
    assert len(axes) == 64 + 20
    np.testing.assert_allclose(np.abs(axes[:64] @ [0.0, 0.0, 1.0]), 1.0)
    np.testing.assert_array_equal(axes[64:], half_sphere(20))


@pytest.mark.parametrize("offset", [[0.0, 0.0, 0.0], [300.0, -500.0, 40.0]])
def test_the_cut_is_between_two_balls_wherever_they_lie(offset: list[float]) -> None:
    d = np.random.default_rng(1).normal(size=(300, 3))
    ball = 0.5 * d / np.linalg.norm(d, axis=1, keepdims=True)
    patches = np.vstack([ball, ball + [1.02, 0.0, 0.0]]) + offset
    found = best_cut(patches, axes_of(patches), np.random.default_rng(0))
    beyond = np.arange(600) >= 300
    assert max((found == beyond).mean(), (found != beyond).mean()) > 0.98
