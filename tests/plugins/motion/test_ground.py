"""The ground's normal, with stones standing on it."""

import numpy as np
import pytest
from executive_plugins.motion.ground import ground_normal

from executive.arrays import Float


def slope(tilt_rad: float, noise_m: float = 0.015) -> Float:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-4, 4, (20000, 2))
    return np.c_[xy, np.tan(tilt_rad) * xy[:, 0] + rng.normal(0, noise_m, len(xy))]


def stone(centre_m: tuple[float, float, float]) -> Float:
    directions = np.random.default_rng(1).normal(size=(3000, 3))
    return np.array(centre_m) + 0.5 * directions / np.linalg.norm(directions, axis=1)[:, None]


@pytest.mark.parametrize("tilt_rad", [0.0, 0.1, 0.3])
def test_finds_the_slope_under_stones(tilt_rad: float) -> None:
    points = np.vstack([slope(tilt_rad), stone((0.0, 0.0, 0.4)), stone((1.5, 0.5, 0.7))])
    normal = ground_normal(points, np.zeros(3))
    expected = np.array([-np.sin(tilt_rad), 0.0, np.cos(tilt_rad)])
    assert np.arccos(normal @ expected) < 0.03


def test_is_straight_up_where_nothing_is_known() -> None:
    np.testing.assert_array_equal(ground_normal(np.zeros((0, 3)), np.zeros(3)), [0, 0, 1])
    np.testing.assert_array_equal(ground_normal(slope(0.3), np.array([50.0, 0, 0])), [0, 0, 1])


def test_takes_no_wall_for_ground() -> None:
    np.testing.assert_array_equal(ground_normal(slope(1.2), np.zeros(3)), [0, 0, 1])


@pytest.mark.parametrize("height_m", [0.3, 0.6])
def test_a_low_bank_beside_the_place_does_not_tilt_the_ground(height_m: float) -> None:
    points = slope(0.1)
    on_bank = (points[:, 0] > 0.5) & (points[:, 0] < 2.4) & (np.abs(points[:, 1]) < 2.6)
    points[on_bank, 2] += height_m
    expected = np.array([-np.sin(0.1), 0.0, np.cos(0.1)])
    assert np.arccos(ground_normal(points, np.zeros(3)) @ expected) < 0.01
