"""Two convex bodies that touch are parted by a plane, and one is not."""

import numpy as np
import pytest
from executive_plugins.segmentation.hollow import is_hollow
from executive_plugins.segmentation.plane_splitting import PlaneSplitter
from executive_plugins.segmentation.two_bodies import (
    axes_of,
    best_cut,
    depths_under_hulls,
    half_sphere,
)
from scipy.spatial import ConvexHull

from executive.arrays import Float, Int

_SIDES_M = np.array([1.0, 0.8, 0.6])


def block(x: float, *, low: float = 0.0, turn_rad: float = 0.0) -> Float:
    """Return the upper faces of a block with its middle at x, and its foot at a height [m],
    shape (2400, 3).
    """
    rng = np.random.default_rng(round(100 * abs(x)) + 7)
    points = rng.uniform(-0.5, 0.5, (2400, 3))
    axis = rng.integers(3, size=len(points))
    sides = np.where(axis == 2, 0.5, rng.choice([-0.5, 0.5], len(points)))
    points[np.arange(len(points)), axis] = sides
    points = points * _SIDES_M + rng.normal(0, 0.006, points.shape)
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    turned = points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return np.asarray(turned + [x, 0, low + 0.3])


def split(points: Float, most_hollow: float = 0.08) -> list[Int]:
    return PlaneSplitter(0.12, 0.25, lambda part: not is_hollow(part, most_hollow)).split(points)


def test_one_block_stays_one() -> None:
    assert [len(rows) for rows in split(block(0.0))] == [2400]


@pytest.mark.parametrize("gap_m", [0.0, 0.02])
def test_two_turned_blocks_that_touch_are_two(gap_m: float) -> None:
    apart_m = 0.5 + 0.64 + gap_m  # half a side, and half of a diagonal
    points = np.vstack([block(0.0), block(apart_m, turn_rad=np.arctan(0.8))])
    found = split(points)
    assert len(found) == 2
    owners = [np.bincount(rows // 2400, minlength=2).max() / len(rows) for rows in found]
    assert min(owners) > 0.95  # a cut follows the borders of patches of 12 cm


def test_a_low_block_beside_a_high_one_is_two() -> None:
    found = split(np.vstack([block(0.0), block(1.0, low=-0.35)]))
    assert len(found) == 2


def test_two_blocks_with_flush_faces_are_taken_for_one() -> None:
    """The limit of the method: together they are one longer block."""
    points = np.vstack([block(0.0), block(1.0)])
    is_seen = np.abs(points[:, 0] - 0.5) > 0.03
    assert len(split(points[is_seen])) == 1


def test_what_was_cut_without_need_is_joined_again() -> None:
    assert len(split(block(0.0), most_hollow=0.0)) == 1


def test_too_few_points_are_not_cut() -> None:
    assert [len(rows) for rows in split(block(0.0)[:15])] == [15]


def test_each_point_is_in_one_part_and_the_answer_is_the_same_twice() -> None:
    aside = block(0.4) + [0, 1.0, 0]
    points = np.vstack([block(0.0), block(1.14, turn_rad=np.arctan(0.8)), aside])
    found, again = split(points), split(points)
    assert len(found) == 3
    assert np.array_equal(np.sort(np.concatenate(found)), np.arange(len(points)))
    assert all(np.array_equal(a, b) for a, b in zip(found, again, strict=True))


def test_the_best_cut_is_between_two_balls() -> None:
    rng = np.random.default_rng(3)
    d = rng.normal(size=(600, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    points = np.vstack([0.5 * d[:300], 0.4 * d[300:] + [0.9, 0, 0]])
    is_beyond = best_cut(points, axes_of(points), np.random.default_rng(0))
    is_second = np.arange(600) >= 300
    assert abs(np.mean(is_beyond == is_second) - 0.5) > 0.48


def test_the_depth_is_that_under_the_hull() -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    inner = np.array([[0.5, 0.5, 0.9], [0.3, 0.5, 0.5]])
    points = np.vstack([corners, inner])
    planes = ConvexHull(points).equations
    exact = -(points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    none = np.zeros(len(points), dtype=bool)
    assert depths_under_hulls(points, np.eye(3), none) == pytest.approx(exact)
    alone = none.copy()
    alone[-1] = True  # a part of one point has no depth
    assert depths_under_hulls(points, np.eye(3), alone)[-1] == 0.0


def test_axes_are_unit_vectors_to_all_sides() -> None:
    axes = half_sphere(40)
    assert np.linalg.norm(axes, axis=1) == pytest.approx(1.0)
    towards = np.abs(half_sphere(500) @ axes.T).max(axis=1)
    assert towards.min() > np.cos(0.35)


@pytest.mark.parametrize(
    ("evidence", "is_one", "bodies"), [(0.9, True, 1), (1.1, True, 2), (0.9, False, 2)]
)
def test_what_may_be_one_stone_is_cut_only_on_clear_evidence(
    monkeypatch: pytest.MonkeyPatch, evidence: float, is_one: bool, bodies: int
) -> None:
    cuts = iter([evidence, *[-1.0] * 9])
    monkeypatch.setattr(PlaneSplitter, "evidence", lambda *told: next(cuts))
    monkeypatch.setattr(PlaneSplitter, "_odds", lambda *told: 0.5)
    answers = iter([is_one, *[True] * 9])
    pair = np.vstack([block(0.0), block(1.1, turn_rad=0.4)])
    assert len(PlaneSplitter(0.12, 0.25, lambda part: next(answers)).split(pair)) == bodies
