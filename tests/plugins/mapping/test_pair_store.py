"""Stored pairs: points move with their pose, removals persist, memory is bounded."""

import numpy as np
import pytest
from executive_plugins.mapping.pair_graph import Poses
from executive_plugins.mapping.pair_store import PairStore

from executive.geometry.pose import pose

HERE = np.eye(4)


def ball(seed: int = 0, centre: tuple[float, float, float] = (5.0, 0.0, 0.0)) -> np.ndarray:
    d = np.random.default_rng(seed).normal(size=(2000, 3))
    return (0.5 * d / np.linalg.norm(d, axis=1)[:, None] + centre).astype(np.float32)


@pytest.fixture
def store() -> PairStore:
    return PairStore(0.03, memory=100, most_pairs=10, arm_m=5.0)


def shown(store: PairStore) -> np.ndarray:
    return store.grid().points()[0]


def moved(x_m: float) -> Poses:
    return Poses(0, np.array([pose(t=np.array([x_m, 0.0, 0.0]))]))


def test_a_pose_that_moves_takes_its_points_with_it(store: PairStore) -> None:
    store.add(0, ball(), HERE, HERE)
    before = shown(store)
    store.move(moved(0.2))
    assert store.is_stale
    np.testing.assert_allclose(
        shown(store).mean(axis=0) - before.mean(axis=0), [0.2, 0, 0], atol=2e-3
    )


def test_a_motion_below_half_a_voxel_does_not_rebuild_the_map(store: PairStore) -> None:
    store.add(0, ball(), HERE, HERE)
    store.move(moved(0.014))
    assert not store.is_stale
    store.move(moved(0.016))
    assert store.is_stale


def test_a_rotation_counts_by_the_motion_of_distant_points(store: PairStore) -> None:
    store.add(0, ball(), HERE, HERE)
    angle = 0.004  # 2 cm at 5 m
    turned = pose(
        np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    )
    store.move(Poses(0, turned[None]))
    assert store.is_stale


def test_removed_voxels_stay_removed_when_poses_move(store: PairStore) -> None:
    store.add(0, np.vstack([ball(), ball(1, (5.0, 3.0, 0.0))]), HERE, HERE)
    assert store.forget_sphere(np.array([5.0, 0.0, 0.0]), 1.0, 1) > 500
    store.move(moved(0.2))
    points = shown(store)
    assert points[:, 1].min() > 2.0
    assert len(points) > 500


def test_pairs_that_left_the_store_stay_in_the_map_and_can_be_removed(store: PairStore) -> None:
    for k in range(25):
        store.add(k, ball(k), HERE, HERE)
        assert len(store) <= 10
    store.move(Poses(15, np.repeat(pose(t=np.array([1.0, 0, 0]))[None], 10, axis=0)))
    points = shown(store)
    assert (points[:, 0] < 4.6).sum() > 100  # the settled ones, where they were
    assert (points[:, 0] > 6.4).sum() > 100  # and the moved ones
    store.forget_sphere(np.array([5.0, 0.0, 0.0]), 0.6, 1)
    store.move(Poses(15, np.repeat(pose(t=np.array([2.0, 0, 0]))[None], 10, axis=0)))
    assert np.linalg.norm(shown(store) - [5.0, 0, 0], axis=1).min() > 0.55


def test_a_surface_stays_where_it_was_put(store: PairStore) -> None:
    store.add(0, ball(1, (5.0, 3.0, 0.0)), HERE, HERE)
    store.add_surface(ball().astype(np.float64))
    store.move(moved(0.5))
    points = shown(store)
    near = points[points[:, 1] < 1.0]
    assert near.mean(axis=0) == pytest.approx([5.0, 0, 0], abs=0.03)
    store.forget_sphere(np.array([5.0, 0.0, 0.0]), 1.0, 1)
    assert shown(store)[:, 1].min() > 2.0


def test_pairs_at_rest_move_with_their_node(store: PairStore) -> None:
    offset = pose(t=np.array([0.0, 0.3, 0.0]))
    store.add(0, ball(), offset, HERE)
    np.testing.assert_allclose(shown(store).mean(axis=0), [5.0, 0.3, 0.0], atol=0.02)
    store.move(moved(0.2))
    np.testing.assert_allclose(shown(store).mean(axis=0), [5.2, 0.3, 0.0], atol=0.02)


def test_voxels_beyond_the_cylinder_are_removed(store: PairStore) -> None:
    store.add(0, ball(), HERE, HERE)
    store.add(1, ball(1, (25.0, 0.0, 0.0)), HERE, HERE)
    store.keep(lambda points: points[:, 0] > 20.0)
    assert len(store) == 1
    assert shown(store)[:, 0].min() > 20.0
