"""Crowded clouds are thinned as they are read: evenly, in their order, and told."""

import logging
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from executive.clouds import point_collector
from executive.clouds.point_collector import PointCollector


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(point_collector, "MOST", 1000)
    monkeypatch.setattr(point_collector, "MOST_APART", 1000)
    monkeypatch.setattr(point_collector, "CHUNK", 400)


def collected(points: np.ndarray) -> np.ndarray:
    collector = PointCollector(Path("site.ply"), len(points))
    collector.add(*points.T)
    return collector.points()


def test_few_points_are_all_kept(small: None) -> None:
    points = np.random.default_rng(0).uniform(0, 10, (1000, 3))
    assert np.array_equal(collected(points), points)


@pytest.mark.parametrize("centre", [0.0, 5.2e6])
def test_what_is_left_is_some_of_the_points_in_their_order_and_near_all(
    small: None, centre: float, caplog: pytest.LogCaptureFixture
) -> None:
    """A square of 8 m by 8 m holds a thousand cells of 25 cm;
    the grid is at most twice as coarse.
    """
    points = np.random.default_rng(0).uniform([-4, -4, 0], [4, 4, 0.01], (6000, 3)) + centre
    with caplog.at_level(logging.WARNING):
        kept = collected(points)
    assert 250 < len(kept) <= 1000
    distances, rows = cKDTree(points).query(kept)
    assert distances.max() == 0.0
    assert (np.diff(rows) > 0).all()
    assert cKDTree(kept).query(points)[0].max() < 0.5 * np.sqrt(2) + 0.01
    assert f"{6000 - len(kept)} of 6000 points are nearer than" in caplog.text


def test_a_wide_site_keeps_points_that_are_farther_apart_than_what_maps_keep(
    small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(point_collector, "MOST_APART", 4000)
    apart = np.random.default_rng(0).uniform([-40, -40, 0], [40, 40, 0.01], (4000, 3))
    assert np.array_equal(collected(apart), apart)
    assert len(collected(apart / 400)) <= 1000  # in a square of 20 cm
    more = np.random.default_rng(0).uniform([-40, -40, 0], [40, 40, 0.01], (9000, 3))
    assert 1000 < len(collected(more)) <= 4000


def test_points_without_a_place_are_counted_apart(
    small: None, caplog: pytest.LogCaptureFixture
) -> None:
    points = np.random.default_rng(0).uniform(0, 1, (3000, 3))
    points[::3] = np.nan
    with caplog.at_level(logging.WARNING):
        assert np.isfinite(collected(points)).all()
    assert "1000 of 3000 points are not finite" in caplog.text
