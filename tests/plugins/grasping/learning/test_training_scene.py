"""Scenes to learn from: stones lie still on the ground, and rays stop where they should."""

from itertools import product

import numpy as np
import pytest
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training_scene import at_rest, convex_solid, look_at
from executive_plugins.grasping.simulated_lift import LIFTED_M

from executive.geometry.pose import transform
from executive.machine.gripper import Gripper

SLAB = np.array(list(product((-0.6, 0.6), (-0.4, 0.4), (-0.2, 0.2))))


def test_a_slab_comes_to_rest_flat_on_the_ground() -> None:
    T = at_rest(SLAB, np.random.default_rng(0))
    assert T is not None
    height = transform(T, SLAB)[:, 2]
    assert height.min() == pytest.approx(0.0, abs=0.01)
    assert height.max() == pytest.approx(0.4, abs=0.01)


def test_rays_stop_at_the_first_face_of_a_convex_stone() -> None:
    directions = np.array(
        [[1.0, 0, 0], [-1.0, 0, 0], [0.8, 0.6, 0.0], [3.0, 0.3, 0.0] / np.hypot(3.0, 0.3)]
    )
    ranges = convex_solid(SLAB)(np.array([-3.0, 0.0, 0.0]), directions)
    np.testing.assert_allclose(ranges, [2.4, np.inf, np.inf, 2.4 * np.hypot(3.0, 0.3) / 3.0])


def test_a_view_shows_the_stone_in_part_with_noise_and_the_ground_around_it() -> None:
    hull = SLAB + (0.0, 0.0, 0.2)
    view = look_at(convex_solid(hull), (), np.random.default_rng(1))
    outside = np.abs(view.stone - (0.0, 0.0, 0.2)) - (0.6, 0.4, 0.2)
    assert outside.max() < 0.15  # five times the largest noise
    ground = view.cloud[len(view.stone) :]
    assert np.median(np.abs(ground[:, 2])) < 0.05
    np.testing.assert_array_equal(view.cloud[: len(view.stone)], view.stone)


def test_a_survey_shows_a_stone_from_all_sides_and_the_soil_that_it_has_sunk_into() -> None:
    """Points lie in the hull of a rough stone; two lidars see its far side at no time."""
    hull = SLAB + (0.0, 0.0, 0.2)
    for seed in range(5):
        view = look_at(convex_solid(hull), (), np.random.default_rng(seed), "surveyed")
        middle = view.stone[(view.stone[:, 2] > 0.15) & (view.stone[:, 2] < 0.3)]
        azimuth = np.arctan2(middle[:, 1], middle[:, 0])
        assert len(np.unique((azimuth / (2 * np.pi) * 8).astype(int))) >= 7
        outside = np.abs(view.stone - (0.0, 0.0, 0.2)) - (0.6, 0.4, 0.2)
        assert -0.05 < np.median(outside.max(axis=1)) < -0.005
        assert outside.max() < 0.06  # five times the largest noise
        ground = view.cloud[len(view.stone) :]
        ground = ground[np.linalg.norm(ground[:, :2], axis=1) > 1.0]
        assert -0.03 < np.median(ground[:, 2]) < 0.06  # four standard deviations


def test_a_neighbour_in_front_hides_the_stone() -> None:
    hull = SLAB + (0.0, 0.0, 0.2)
    ring = tuple(
        convex_solid(np.array(list(product((x - 0.3, x + 0.3), (y - 0.3, y + 0.3), (0.0, 5.0)))))
        for x, y in product((-1.2, -0.6, 0.0, 0.6, 1.2), repeat=2)
        if max(abs(x), abs(y)) > 1
    )
    free, hidden = (
        look_at(convex_solid(hull), others, np.random.default_rng(2)) for others in ((), ring)
    )
    assert len(hidden.stone) < 0.5 * len(free.stone)


def test_a_good_grasp_lifts_under_noise_and_one_in_the_air_never(gripper: Gripper) -> None:
    block = np.array(list(product((-0.4, 0.4), (-0.4, 0.4), (0.0, 0.7))))
    T = np.array([[0.0, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 0, 1.25], [0, 0, 0, 1]]) @ np.diag(
        [1.0, 1, -1, 1]
    )
    T[:3, 2] = np.cross(T[:3, 0], T[:3, 1])
    rng, trials = np.random.default_rng(0), LiftTrials(gripper, block)
    slips = [trials.lift(T, 0.6 * gripper.open_rad, rng) for _ in range(5)]
    assert np.mean(np.array(slips) <= LIFTED_M) >= 0.8
    T[2, 3] = 2.6
    assert trials.lift(T, 0.6 * gripper.open_rad, rng) > LIFTED_M
