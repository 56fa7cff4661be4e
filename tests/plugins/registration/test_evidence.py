"""What observations of stones cost, as numbers, and how many stones may agree."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from executive_plugins.registration.evidence import CAP, Evidence, StoneFit
from executive_plugins.registration.similarity import Similarity, Surface
from executive_plugins.registration.site_view import SiteView


def fit(costs: list[float], weights: list[float]) -> StoneFit:
    pairs = tuple((k, k) for k in range(len(costs)))
    return StoneFit(pairs, pairs, np.array(costs), np.array(weights))


def test_the_mean_is_over_observations() -> None:
    assert fit([1.0, 4.0], [30.0, 10.0]).mean_cost == pytest.approx(1.75)


def test_without_a_stone_it_is_the_largest_cost() -> None:
    assert fit([], []).mean_cost == CAP == 3.0**2 / 2  # of three standard deviations


def test_the_excess_is_the_sum_over_observations_of_what_is_more_than_usual() -> None:
    assert fit([1.0, 4.0], [30.0, 10.0]).excess(0.5) == pytest.approx(15.0 + 35.0)
    assert fit([1.0], [8.0]).excess(1.5) == pytest.approx(-4.0)
    assert fit([], []).excess(0.5) == 0.0


@pytest.mark.parametrize(("enough", "counted"), [(1, 1), (2, 2), (9, 2)])
def test_it_counts_stones_that_may_agree_until_there_are_enough(enough: int, counted: int) -> None:
    face = np.mgrid[0:5, 0:5, 0:1].reshape(3, -1).T * 0.1
    places = (0.0, 5.0, 10.0)

    def seen(*lifts_m: float) -> SiteView:
        shapes = [face + [x, 0.0, z] for x, z in zip(places, lifts_m, strict=True)]
        return cast(SiteView, SimpleNamespace(stones=[*map(Surface, shapes)], spacing_m=0.1))

    evidence = Evidence(seen(0.0, 0.0, 0.0), seen(0.0, 0.5, 0.0), 0.1, 0.6)
    pairs = ((0, 0), (1, 1), (2, 2))
    assert evidence.count_alike(Similarity(np.eye(4), 1.0), pairs, enough) == counted
