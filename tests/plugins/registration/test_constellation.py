"""Motions guessed from where stones stand."""

import numpy as np
import pytest
from executive_plugins.registration.constellation import (
    _distinct,
    _hypotheses,
    _nearest_grid,
    _support,
    constellation_transforms,
)

from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, exp_so3, from_rpy

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


@pytest.mark.parametrize("spread_m", [0.5, 6.0, 2000.0])
def test_the_grid_names_the_nearest_centroid_up_to_the_reach_and_none_beyond(
    spread_m: float,
) -> None:
    """A search of all centroids is the measure, at the centre of every cell."""
    rng = np.random.default_rng(7)
    t = rng.uniform(-1, 1, (9, 2)) * [spread_m, 0.5 * spread_m] + [40.0, -7.0]
    vote_m = 1.0
    nearest, low, cell_m = _nearest_grid(t, vote_m)
    assert nearest.size < 260_000  # memory is bounded however far the stones are
    shape = np.array(nearest.shape)
    np.testing.assert_allclose(low, t.min(axis=0) - vote_m)
    np.testing.assert_array_less(t.max(axis=0) + vote_m, low + shape * cell_m)
    np.testing.assert_array_less(low + (shape - 1) * cell_m, t.max(axis=0) + vote_m + 1e-9)
    centres = np.stack(np.indices(nearest.shape), axis=2) * cell_m + low + 0.5 * cell_m
    distance = np.linalg.norm(centres[:, :, None] - t, axis=3)
    expected = distance.argmin(axis=2)
    expected[distance.min(axis=2) > vote_m + cell_m] = -1
    assert (nearest == expected).all()


@pytest.mark.parametrize("vote_m", [0.7, 2.0])
def test_support_is_what_a_search_of_all_centroids_gives(vote_m: float) -> None:
    """By how much each moved centroid is nearer than the reach, up to the width of a cell."""
    rng = np.random.default_rng(8)
    t = rng.uniform(-4, 4, (8, 2))
    s = np.vstack([[40.0, 30.0], t[:5] + rng.normal(0, 0.1, (5, 2))])  # one is never in the grid
    yaws = rng.normal(0, 0.2, 40)
    R = np.array([[np.cos(yaws), -np.sin(yaws)], [np.sin(yaws), np.cos(yaws)]]).transpose(2, 0, 1)
    headings = np.concatenate([R, rng.uniform(-1, 1, (40, 2, 1))], axis=2)
    grid = _nearest_grid(t, vote_m)
    moved = np.einsum("hij,nj->hni", R, s) + headings[:, None, :, 2]
    distance = np.linalg.norm(moved[:, :, None] - t, axis=3).min(axis=2)
    expected = np.maximum(vote_m - distance, 0.0).sum(axis=1)
    found = _support(headings, s, t, *grid, vote_m)
    np.testing.assert_array_less(found, expected + 1e-9)  # a cell may name a farther one
    np.testing.assert_array_less(expected - len(s) * grid[2], found)
    assert expected.max() > vote_m  # several support a motion


def test_at_most_so_many_motions_are_ranked_and_these_are_an_even_share() -> None:
    """A hundred stones on a grid: all pairs agree with many others, in the order of the stones."""
    t = np.stack(np.indices((10, 10)), axis=2).reshape(-1, 2) * 1.0
    found = _hypotheses(t, t, 0.1)
    assert 30_000 < len(found) <= 60_000
    # The share reaches the last stones: motions that leave the last pair in its place are there.
    yaw = np.arctan2(found[:, 1, 0], found[:, 0, 0])
    fixed = np.abs(found[:, :, :2] @ t[-1] + found[:, :, 2] - t[-1]).max(axis=1) < 1e-9
    assert (fixed & (np.abs(yaw) < 1e-9)).any()


@pytest.mark.parametrize(("apart_m", "count"), [(0.79, 0), (0.8, 2), (3.0, 2)])
def test_a_pair_that_is_close_together_determines_no_heading(apart_m: float, count: int) -> None:
    pair = np.array([[1.0, 2.0], [1.0 + apart_m, 2.0]])
    assert len(_hypotheses(pair, pair, 0.5)) == count


@pytest.mark.parametrize(("longer_m", "count"), [(0.24, 2), (-0.24, 2), (0.26, 0), (-0.26, 0)])
def test_pairs_agree_up_to_the_tolerance(longer_m: float, count: int) -> None:
    pair = np.array([[0.0, 0.0], [2.0, 0.0]])
    found = _hypotheses(pair * (1 + 0.5 * longer_m), pair, 0.25)
    assert len(found) == count
    for motion in found:  # the middles lie on each other, in both directions
        moved = motion[:, :2] @ [1.0, 0.0] + motion[:, 2]
        np.testing.assert_allclose(moved, [1 + 0.5 * longer_m, 0.0], atol=1e-9)


def test_motions_that_differ_by_less_than_a_stone_are_told_once() -> None:
    """The first of each group stays, whichever centroid it is that differs, and in x or in y."""
    shifts = np.array([[0, 0], [0.29, 0], [0, 0.29], [0.31, 0], [0, -0.31], [0.31, 0.29], [9, 9]])
    headings = np.concatenate([np.tile(np.eye(2), (7, 1, 1)), shifts[:, :, None]], axis=2)
    s = np.array([[0.0, 0.0], [3.0, 1.0]])
    order = np.arange(7)
    assert _distinct(headings, order, s, 10).tolist() == [0, 3, 4, 6]
    assert _distinct(headings, order[::-1], s, 10).tolist() == [6, 5, 4, 2]
    assert _distinct(headings, order, s, 2).tolist() == [0, 3]
    turned = np.concatenate([exp_so3(np.array([0, 0, 0.11]))[:2, :2], np.zeros((2, 1))], axis=1)
    far = np.vstack([s[:1], [[0.0, 3.0]]])  # the second alone moves, by 0.33 m
    assert _distinct(np.stack([headings[0], turned]), order[:2], far, 10).tolist() == [0, 1]
