"""Slivers along a seam are given back; stones are not, on balls and boxes that are cut wrongly."""

import numpy as np
import pytest
from executive_plugins.segmentation.plane_splitting import PlaneSplitter
from executive_plugins.segmentation.seam_slivers import SeamSlivers

from executive.arrays import Float, Int

PATCH_M = 0.12


def ball(middle: Float, radius_m: float, count: int = 4000) -> Float:
    """Return points on a ball [m]."""
    directions = np.random.default_rng(1).normal(size=(count, 3))
    return np.asarray(middle + radius_m * directions / np.linalg.norm(directions, axis=1)[:, None])


def slivers(least_points: int = 60) -> SeamSlivers:
    cuts = PlaneSplitter(PATCH_M, 0.24, lambda points: True)
    return SeamSlivers(PATCH_M, least_points, cuts.odds)


BALLS = np.vstack([ball(np.array([-0.5, 0, 0.5]), 0.5), ball(np.array([0.5, 0, 0.5]), 0.5)])
IS_SECOND = np.arange(len(BALLS)) >= 4000


def parts_of(groups: Int) -> list[Int]:
    return [np.flatnonzero(groups == k) for k in np.unique(groups)]


def test_a_sliver_of_two_stones_is_given_back_to_each() -> None:
    """Two balls that touch, and what lies within 0.15 m of the plane between them."""
    at_seam = np.abs(BALLS[:, 0]) < 0.15
    cut = parts_of(np.where(at_seam, 2, IS_SECOND))
    assert len(cut[2]) > 60
    one, other = slivers().given_back(BALLS, cut)
    assert np.isin(one, np.flatnonzero(IS_SECOND)).mean() < 0.01
    assert np.isin(other, np.flatnonzero(IS_SECOND)).mean() > 0.99
    assert np.array_equal(np.sort(np.concatenate([one, other])), np.arange(len(BALLS)))


def test_a_stone_beside_two_others_stays_one() -> None:
    """Its neighbours are larger, but what each of them would get stands out of it."""
    third = ball(np.array([0.0, 0.6, 0.3]), 0.3, 1000)
    points = np.vstack([BALLS, third])
    cut = parts_of(np.concatenate([IS_SECOND.astype(int), np.full(1000, 2)]))
    kept = slivers().given_back(points, cut)
    assert [len(part) for part in kept] == [4000, 4000, 1000]


@pytest.mark.parametrize(("least", "parts"), [(300, 1), (100, 2)])
def test_a_part_of_too_few_points_is_given_to_its_only_neighbour(least: int, parts: int) -> None:
    first = BALLS[~IS_SECOND]
    cut = parts_of((first[:, 0] > -0.05).astype(int))
    assert 100 < len(cut[1]) < 300
    assert len(slivers(least).given_back(first, cut)) == parts


def test_a_part_far_from_all_others_stays_however_small() -> None:
    points = np.vstack([BALLS[~IS_SECOND], ball(np.array([3.0, 0, 0.2]), 0.1, 20)])
    cut = [np.arange(4000), np.arange(4000, 4020)]
    assert [len(part) for part in slivers().given_back(points, cut)] == [4000, 20]


def test_a_whole_cluster_is_left_as_it_is() -> None:
    cut = [np.arange(len(BALLS))]
    assert slivers().given_back(BALLS, cut) == cut
