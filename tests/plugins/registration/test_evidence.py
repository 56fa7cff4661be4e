"""What observations of stones cost, as numbers."""

import numpy as np
import pytest
from executive_plugins.registration.evidence import CAP, StoneFit


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
