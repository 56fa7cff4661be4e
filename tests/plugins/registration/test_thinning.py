"""Clouds about their middle."""

import numpy as np
from executive_plugins.registration.thinning import less, mean_point, sampled

POINTS = np.random.default_rng(0).normal(0, 5, (1000, 3)) + [4e5, 5e6, 300.0]


def test_the_mean_is_that_of_numpy_to_the_bit() -> None:
    assert np.array_equal(mean_point(POINTS), POINTS.mean(axis=0))


def test_points_less_their_mean_are_those_of_numpy_to_the_bit() -> None:
    assert np.array_equal(less(POINTS, mean_point(POINTS)), POINTS - POINTS.mean(axis=0))


def test_what_is_read_only_may_be_given() -> None:
    points = POINTS.copy()
    points.flags.writeable = False
    assert np.array_equal(less(points, np.zeros(3)), POINTS)


def test_no_more_than_the_most_are_sampled() -> None:
    assert [len(sampled(POINTS, most)) for most in (10, 300, 1000, 2000)] == [10, 250, 1000, 1000]
