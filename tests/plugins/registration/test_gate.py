"""What surfaces say, and which segments pair up."""

import numpy as np
import pytest
from executive_plugins.registration.centroid_matching import matched_centroids
from executive_plugins.registration.gate import NOTHING, measure


def sheet(low: float, high: float, height: float = 0.0) -> np.ndarray:
    x, y = np.meshgrid(np.arange(low, high, 0.02), np.arange(0, 1, 0.02))
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)])


def test_a_half_seen_surface_agrees_by_the_way_that_covers_more() -> None:
    agreement = measure(sheet(0, 1), sheet(0, 2, 0.03), 0.1, 0.02)
    assert agreement.target.share == pytest.approx(1.0)
    assert agreement.source.share == pytest.approx(
        0.55, abs=0.03
    )  # half, and a margin of the truncation
    assert agreement.better is agreement.target
    assert agreement.better.rmse_m == pytest.approx(0.03, abs=0.003)


def test_surfaces_apart_share_nothing() -> None:
    agreement = measure(sheet(0, 1), sheet(0, 1, 0.2), 0.1, 0.02)
    assert (agreement.source.share, agreement.target.share, agreement.better.rmse_m) == (
        0.0,
        0.0,
        0.0,
    )


def test_agreements_add_up_as_one_surface() -> None:
    good, bad = (
        measure(sheet(0, 1), sheet(0, 1, 0.02), 0.1, 0.02),
        measure(sheet(0, 1), sheet(0, 1, 0.2), 0.1, 0.02),
    )
    both = sum([good, bad], NOTHING)
    assert both.source.share == pytest.approx(0.5)
    assert both.source.rmse_m == pytest.approx(good.source.rmse_m)
    assert NOTHING.better.share == 0.0


def test_two_sources_never_share_a_target() -> None:
    target = np.array([[0.0, 0, 0], [1.5, 0, 0]])
    moved = np.array([[0.1, 0, 0], [0.6, 0, 0], [9.0, 0, 0]])
    assert matched_centroids(target, moved, 1.0) == ((0, 0), (1, 1))


def test_pairs_beyond_the_reach_do_not_match() -> None:
    assert matched_centroids(np.zeros((1, 3)), np.array([[1.1, 0, 0]]), 1.0) == ()
    assert matched_centroids(np.empty((0, 3)), np.zeros((2, 3)), 1.0) == ()
