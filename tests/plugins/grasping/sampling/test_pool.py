"""The pool: grasps that have held the stone before are among those that are tried."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.pool import Pool, Sampler
from executive_plugins.grasping.sampling.settings import SamplingSettings

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy


@pytest.fixture(scope="module")
def pools(gripper):
    """Return a function that samples the grasps of a boulder on level ground."""
    sampler = Sampler(SamplingSettings(samples=12, downward_yaws=6), gripper)
    drawn = np.random.default_rng(8)
    polar, azimuth = np.arccos(drawn.uniform(-1, 1, 1500)), drawn.uniform(0, 2 * np.pi, 1500)
    x, y = np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar)
    stone = np.column_stack([x, y, np.cos(polar)]) * (0.6, 0.45, 0.4) + (0.0, 0.0, 0.35)
    stone = stone[stone[:, 2] > 0.02]
    ground = np.column_stack([drawn.uniform(-2, 2, (3000, 2)), drawn.normal(0, 0.005, 3000)])

    def pools(T_map_gripper: Float | None = None) -> Pool:
        rng = np.random.default_rng(9)
        scene = sampler.scene(stone, np.vstack([stone, ground]), rng)
        return sampler.pool(scene, rng, T_map_gripper)

    return pools


def down(yaw_rad: float, height_m: float) -> Float:
    """Return a gripper above the boulder that points down."""
    return pose(from_rpy(0.0, np.pi / 2, yaw_rad), np.array([0.0, 0.0, height_m]))


def test_without_a_grasp_from_before_none_has_held(pools) -> None:
    assert len(pools()) > 0
    assert not pools().times_held.any()
    assert not pools(np.empty((0, 4, 4))).times_held.any()


def test_grasps_that_held_come_first_the_newest_ahead_and_change_no_other_one(pools) -> None:
    known = np.array([down(0.3, 1.3), down(0.9, 1.3)])
    pool, without = pools(known), pools()
    assert pool.times_held.tolist() == [1, 1] + [0] * len(without)
    np.testing.assert_array_equal(pool.position[2:], without.position)
    # The frame of the planning cloud is the stone's, so yaws are compared with each other.
    turn = pool.R[0].T @ pool.R[1]
    assert np.arccos((np.trace(turn) - 1) / 2) == pytest.approx(0.6, abs=1e-6)
    turned = pools(known[::-1])
    np.testing.assert_allclose(turned.R[[1, 0]], pool.R[:2], atol=1e-9)


def test_grasps_that_are_alike_are_one_that_has_held_more_often(pools) -> None:
    """The newest is tried; jaws that are swapped are the same grasp."""
    swapped = down(0.3, 1.32) @ pose(from_rpy(np.pi, 0.0, 0.0))
    pool = pools(np.array([swapped, down(0.9, 1.3), down(0.35, 1.3)]))
    assert pool.times_held[:3].tolist() == [2, 1, 0]
    only = pools(np.array([down(0.35, 1.3)]))
    np.testing.assert_allclose(pool.R[0], only.R[0], atol=1e-9)


def test_a_grasp_of_a_stone_that_has_turned_since_is_too_steep(pools) -> None:
    lying = down(0.3, 1.3) @ pose(from_rpy(0.0, 0.0, np.pi / 2))
    pool = pools(np.array([lying, down(0.3, 1.3)]))
    assert pool.times_held.sum() == 1


def test_a_grasp_beside_the_stone_holds_nothing(pools) -> None:
    beside = down(0.3, 1.3)
    beside[:2, 3] = (3.0, 0.0)
    assert not pools(np.array([beside])).times_held.any()
