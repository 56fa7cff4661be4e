"""The ground's slow undulation."""

import numpy as np
import pytest
from executive_plugins.segmentation.ground_surface import fit_ground_surface

from executive.errors import DataError

LEVEL = np.array([0.0, 0.0, 1.0, 0.0])


def waves(xy: np.ndarray) -> np.ndarray:
    return 0.12 * np.sin(xy[:, 0] * 0.9) * np.cos(xy[:, 1] * 0.7)


def ground(rng: np.random.Generator, count: int = 20000) -> np.ndarray:
    xy = rng.uniform(-10, 10, (count, 2))
    return np.column_stack([xy, waves(xy) + rng.normal(0, 0.01, count)])


def test_waves_of_seven_metres_are_followed_to_a_few_centimetres() -> None:
    points = ground(np.random.default_rng(0))
    terrain = fit_ground_surface(points, LEVEL, node_m=1.0, relief_m=0.3, stiffness=0.2)
    inner = np.abs(points[:, :2]).max(axis=1) < 9
    assert np.abs(points[:, 2]).max() > 0.12  # a plane alone would leave this
    assert np.sqrt(np.mean(terrain.heights_above(points)[inner] ** 2)) < 0.02
    assert np.abs(terrain.heights_above(points)[inner]).max() < 0.09  # below the margin of 10 cm


def test_a_stone_is_not_climbed() -> None:
    rng = np.random.default_rng(0)
    points = ground(rng)
    on_stone = np.linalg.norm(points[:, :2] - [2, 3], axis=1) < 0.8
    top = rng.uniform(-0.56, 0.56, (600, 2)) + np.array([2, 3])
    stone = np.column_stack(
        [top, waves(top) + 0.25]
    )  # flat, and low enough to be taken for ground at first
    terrain = fit_ground_surface(np.vstack([points[~on_stone], stone]), LEVEL, 1.0, 0.3, 0.2)
    np.testing.assert_allclose(terrain.heights_above(stone), 0.25, atol=0.06)


def test_heights_on_a_plane_are_exact() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-5, 5, (5000, 2))
    normal = np.array([0.1, -0.2, 1.0]) / np.linalg.norm([0.1, -0.2, 1.0])
    points = np.column_stack([xy, -(xy @ normal[:2]) / normal[2]])
    terrain = fit_ground_surface(points, np.array([*normal, 0.0]), 1.0, 0.3, 0.2)
    raised = points + 0.4 * normal
    np.testing.assert_allclose(terrain.heights_above(raised), 0.4, atol=1e-6)


def test_a_cloud_in_millimetres_is_named() -> None:
    with pytest.raises(DataError, match="unit is the metre"):
        fit_ground_surface(ground(np.random.default_rng(0)) * 1000, LEVEL, 1.0, 0.3, 0.2)
