"""Stones parted by the convexity of their surfaces: parts of one ball are joined, two are not."""

import numpy as np
import pytest
from executive_plugins.segmentation.convex_splitting import ConvexSplitter

from executive.arrays import Float, Int

PARTING = ConvexSplitter(0.1, 0.3, 40, 0.25, 2.0, 0.08)


def ball(x: float = 0.0, radius_m: float = 0.5, count: int = 900) -> Float:
    """Return the surface of a ball, shape (N, 3)."""
    d = np.random.default_rng(3).normal(size=(count, 3))
    return np.asarray(radius_m * d / np.linalg.norm(d, axis=1, keepdims=True) + [x, 0.0, radius_m])


def sectors(points: Float, count: int) -> list[Int]:
    """Return the rows of sectors about the vertical through the middle."""
    off = points - points.mean(axis=0)
    sector = np.floor((np.arctan2(off[:, 1], off[:, 0]) + np.pi) / (2 * np.pi) * count).astype(int)
    return [np.flatnonzero(np.clip(sector, 0, count - 1) == k) for k in range(count)]


@pytest.mark.parametrize("count", [2, 3, 5])
def test_parts_of_one_ball_are_joined_and_each_point_is_in_it_once(count: int) -> None:
    points = ball()
    (whole,) = PARTING._joined(points, sectors(points, count))
    np.testing.assert_array_equal(whole, np.arange(len(points)))


def test_parts_are_joined_with_those_of_their_own_ball() -> None:
    points = np.vstack([ball(), ball(1.0)])
    parts = [*sectors(ball(), 2), *(900 + rows for rows in sectors(ball(1.0), 2))]
    found = PARTING._joined(points, [parts[k] for k in (0, 2, 1, 3)])
    assert sorted(map(len, found)) == [900, 900]
    for rows in found:
        assert len(np.unique(rows // 900)) == 1


def test_what_would_be_longer_than_a_stone_or_is_no_neighbour_stays_apart() -> None:
    points = ball()
    short = ConvexSplitter(0.1, 0.3, 40, 0.25, 0.9, 0.08)
    assert len(short._joined(points, sectors(points, 2))) == 2
    small = np.vstack([ball(0.0, 0.2), ball(0.55, 0.2)])  # 15 cm apart, more than a patch
    assert len(PARTING._joined(small, [np.arange(900), np.arange(900, 1800)])) == 2


@pytest.mark.parametrize("places", [[0.0], [0.0, 1.02]])
def test_each_point_is_in_one_part_and_as_many_tops_are_counted(places: list[float]) -> None:
    points = np.vstack([ball(x) for x in places])
    parts = PARTING.split(points, points[:, :2], points[:, 2])
    np.testing.assert_array_equal(np.sort(np.concatenate(parts)), np.arange(len(points)))
    assert len(parts) >= len(places)
    assert PARTING.count_tops(points[:, :2], points[:, 2]) == len(parts)


def test_of_what_is_too_long_for_a_stone_half_the_hollow_is_allowed() -> None:
    """Two balls side by side are as hollow whatever is called too long."""
    both = np.vstack([ball(), ball(0.8)])
    shares = []
    for most_extent_m in (5.0, 1.0):
        limits = [
            limit
            for limit in np.linspace(0.01, 1.0, 100)
            if ConvexSplitter(0.1, 0.3, 40, 0.25, most_extent_m, limit).is_one(both)
        ]
        shares.append(min(limits))
    assert shares[1] == pytest.approx(2 * shares[0], abs=0.021)
