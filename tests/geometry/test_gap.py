"""How far a held stone is above the ground, also where the map has forgotten the ground."""

import numpy as np
import pytest

from executive.geometry.gap import gap_below

STONE = np.random.default_rng(0).uniform(-0.4, 0.4, (200, 3)) + [5.0, 0.0, 1.2]
LOWEST_M = STONE[:, 2].min()


def ground(height=lambda x, y: 0.1 * x):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(2, 8, 0.05), np.arange(-3, 3, 0.05)))
    return np.c_[x, y, height(x, y)]


def test_is_measured_to_the_highest_point_under_the_stone():
    boulder = np.array([[5.1, 0.1, 0.62]])
    assert gap_below(STONE, np.vstack([ground(), boulder])) == pytest.approx(LOWEST_M - 0.62)
    beside = np.array([[5.9, 0.0, 0.7]])
    assert gap_below(STONE, np.vstack([ground(), beside])) == pytest.approx(
        LOWEST_M - 0.54, abs=0.01
    )


def test_over_ground_that_the_map_has_forgotten_what_lies_around_it_stands_for_it():
    points = ground()
    forgotten = points[np.linalg.norm(points - [5.0, 0.0, 0.9], axis=1) > 1.0]
    assert gap_below(STONE, forgotten) == pytest.approx(LOWEST_M - 0.5, abs=0.06)


def test_over_nothing_there_is_no_gap():
    assert gap_below(STONE, np.zeros((0, 3))) == 0.0
