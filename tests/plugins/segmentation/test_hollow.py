"""What is hollow is no single stone."""

import numpy as np
import pytest
from executive_plugins.segmentation.hollow import hollow_share, is_hollow

from executive.arrays import Float


def ball(x: float = 0.0) -> Float:
    d = np.random.default_rng(0).normal(size=(3000, 3))
    return np.asarray(0.5 * d / np.linalg.norm(d, axis=1)[:, None] + [x, 0, 0])


def test_a_ball_is_not_hollow() -> None:
    assert hollow_share(ball()) < 0.02


def test_two_touching_balls_are_hollow_about_where_they_touch() -> None:
    # The hull is a capsule of radius 0.5, so a point at a distance x from its ball's middle along
    # the axis lies 0.5 − sqrt(0.25 − x²) under it. By Archimedes x is even over the ball.
    pair = np.vstack([ball(-0.5), ball(0.5)])
    x = 0.5 - 0.05  # one point in twenty, on the inner side, is farther along
    assert hollow_share(pair) == pytest.approx((0.5 - np.sqrt(0.25 - x**2)) / 2, abs=0.02)


def test_it_has_no_unit() -> None:
    pair = np.vstack([ball(-0.5), ball(0.5)])
    assert hollow_share(1000 * pair) == pytest.approx(hollow_share(pair))


@pytest.mark.parametrize(
    "points",
    [np.random.default_rng(0).uniform(0, 1, (50, 3)) * [1, 1, 0], np.zeros((9, 3)), np.eye(3)],
    ids=["a plane", "one place", "three points"],
)
def test_what_has_no_hull_is_not_hollow(points: Float) -> None:
    assert hollow_share(points) == 0.0


def test_a_reflection_in_the_air_does_not_make_a_ball_hollow() -> None:
    strayed = np.vstack([ball(), [[0.0, 0.0, 1.5], [1.4, 0.0, 0.0]]])
    assert hollow_share(strayed) < 0.03  # its longest side counts the points in the air
    two = np.vstack([ball(-0.5), ball(0.5), [[0.0, 0.0, 1.5]]])
    assert hollow_share(two) > 0.1


@pytest.mark.parametrize("apart_m", [0.0, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("strays", [0, 600])
def test_the_quick_answer_is_that_of_the_hull(apart_m: float, strays: int) -> None:
    air = np.random.default_rng(1).uniform(-2, 2, (strays, 3))
    pair = np.vstack([ball(-apart_m / 2), ball(apart_m / 2), air])
    share = hollow_share(pair)
    for most in (0.5 * share, 0.99 * share, 1.01 * share, 1.5 * share, 0.08):
        assert is_hollow(pair, most) == (share > most)
