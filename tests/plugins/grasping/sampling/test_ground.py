"""The ground under and about a stone, where it is known and where it is not."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.ground import Ground, fill_ground, fit_ground

BOX = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (-0.4, 0.4) for z in (0.1, 0.7)])


def plain(slope: float = 0.0, without_m: float = 0.5, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-2, 2, (6000, 2))
    xy = xy[(np.abs(xy) > without_m).any(axis=1)]
    return np.column_stack([xy, slope * xy[:, 0] + rng.normal(0, 0.01, len(xy))])


def test_finds_the_slope_of_a_plane() -> None:
    ground = fit_ground(plain(0.2), BOX, np.random.default_rng(0))
    np.testing.assert_allclose(ground.normal, np.array([-0.2, 0, 1]) / np.hypot(0.2, 1), atol=0.02)
    np.testing.assert_allclose(
        ground.height(np.array([[1.0, 0.5], [-1.0, 0.0]])), [0.2, -0.2], atol=0.04
    )


def test_neighbours_do_not_lift_the_ground() -> None:
    rng = np.random.default_rng(1)
    neighbours = rng.uniform([0.8, -2, 0.2], [2, 2, 0.8], (4000, 3))
    ground = fit_ground(np.concatenate([plain(), neighbours]), BOX, np.random.default_rng(0))
    assert ground.normal[2] > np.cos(np.radians(3))
    assert abs(ground.height(np.zeros((1, 2)))[0]) < 0.04


def test_follows_undulations_about_its_plane() -> None:
    points = plain()
    points[:, 2] += 0.08 * np.sin(2 * points[:, 0])
    ground = fit_ground(points, BOX, np.random.default_rng(0))
    x = np.array([-1.5, -0.8, 0.8, 1.5])
    np.testing.assert_allclose(
        ground.height(np.column_stack([x, np.zeros(4)])), 0.08 * np.sin(2 * x), atol=0.04
    )


def test_the_hidden_ground_is_filled_at_the_given_density() -> None:
    ground = fit_ground(plain(), BOX, np.random.default_rng(0))
    filled = fill_ground(ground, BOX, np.array([-1.0, -1.0]), np.array([1.0, 1.0]), 0.05)
    hidden = filled[(np.abs(filled[:, :2]) < 0.4).all(axis=1)]
    assert len(hidden) == pytest.approx((0.8 / 0.05) ** 2, rel=0.15)
    np.testing.assert_allclose(hidden[:, 2], 0.0, atol=0.04)


def test_the_fill_does_not_pass_through_a_sunk_stone() -> None:
    x = np.arange(-0.4, 0.41, 0.04)
    sunk = np.array([[a, b, -0.2] for a in x for b in x])
    ground = fit_ground(plain(), sunk, np.random.default_rng(0))
    filled = fill_ground(ground, sunk, np.array([-1.0, -1.0]), np.array([1.0, 1.0]), 0.05)
    assert (np.abs(filled[:, :2]) > 0.38).any(axis=1).all()


def test_without_surroundings_the_ground_is_level_at_the_lowest_point() -> None:
    ground = fit_ground(np.empty((0, 3)), BOX, np.random.default_rng(0))
    np.testing.assert_array_equal(ground.normal, [0, 0, 1])
    np.testing.assert_allclose(ground.height(np.array([[3.0, -2.0]])), [0.1])


def test_on_a_steep_plane_the_height_is_the_samples_own() -> None:
    """Samples that lie on the plane deviate from it by nothing, however it is tilted."""
    normal = np.array([0.5, -0.3, 0.7]) / np.linalg.norm([0.5, -0.3, 0.7])
    xy = np.stack(np.meshgrid(np.arange(-2.0, 2.1, 0.5), np.arange(-2.0, 2.1, 0.5)), -1)
    xy = xy.reshape(-1, 2)
    z = (0.4 - xy @ normal[:2]) / normal[2]
    ground = Ground(normal, 0.4, np.column_stack([xy, z]), 0.5)
    np.testing.assert_allclose(ground.height(xy), z, atol=1e-9)
    bare = Ground(normal, 0.4, np.empty((0, 3)), 0.5)
    np.testing.assert_allclose(bare.height(xy), z, atol=1e-9)
