"""When two motions are one: by where they lay the stones."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.registration.matchup import Matchup, centroids, joined
from executive_plugins.registration.similarity import Similarity

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.segment import Segment


def stones(*places: float) -> SimpleNamespace:
    """Return stones of two points each along x."""
    segments = []
    for number, x in enumerate(places):
        points = np.array([[x - 0.5, 1.0, 0.0], [x + 0.5, 1.0, 0.0]])
        segments.append(Segment(number, points, points.mean(axis=0), np.ones(3)))
    middles = np.empty((0, 3)), centroids(segments)
    return SimpleNamespace(source=SimpleNamespace(segments=segments), middles=middles)


def shifted(x_m: float, yaw_rad: float = 0.0, scale: float = 1.0) -> Similarity:
    return Similarity(pose(from_rpy(0.0, 0.0, yaw_rad), np.array([x_m, 50.0, 0.0])), scale)


@pytest.mark.parametrize(
    ("other", "is_same"),
    [
        (shifted(0.0), True),
        (shifted(0.29), True),
        (shifted(0.31), False),
        (shifted(0.0, 0.029), True),  # 10 m from the origin
        (shifted(0.0, 0.031), False),
        (shifted(0.0, scale=1.029), True),
        (shifted(0.0, scale=1.031), False),
    ],
)
def test_two_motions_are_one_that_lay_no_stone_farther_apart_than_a_third_of_a_metre(
    other: Similarity, is_same: bool
) -> None:
    site = stones(1.0, 9.95)
    assert Matchup.is_same(site, shifted(0.0), other) is is_same
    assert Matchup.is_same(site, other, shifted(0.0)) is is_same


def test_centroids_and_points_are_in_the_order_of_the_stones() -> None:
    segments = stones(3.0, 1.0).source.segments
    np.testing.assert_array_equal(centroids(segments), [[3.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    np.testing.assert_array_equal(joined(segments)[:, 0], [2.5, 3.5, 0.5, 1.5])
    assert centroids([]).shape == (0, 3)
