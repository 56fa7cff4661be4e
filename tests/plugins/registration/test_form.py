"""Form of two surfaces: blind to noise and density, not to shape."""

import numpy as np
import pytest
from executive_plugins.registration.form import form_error
from executive_plugins.registration.similarity import Surface

REACH_M = 0.10


def ball(radius_m: float, count: int, seed: int, noise_m: float = 0.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return directions * (radius_m + rng.normal(0, noise_m, count))[:, None]


SURFACE = Surface.thinned(ball(0.5, 8000, 0), 0.015)


@pytest.mark.parametrize("difference_m", [-0.03, -0.01, 0.01, 0.03])
def test_a_larger_or_smaller_ball_differs_by_its_radius(difference_m: float) -> None:
    # 2 mm: a chord between two points lies below the ball.
    assert form_error(SURFACE, ball(0.5 + difference_m, 3000, 1), REACH_M) == pytest.approx(
        abs(difference_m), abs=0.002
    )


@pytest.mark.parametrize("count", [800, 3000])
def test_noise_of_a_centimetre_and_thin_sampling_are_no_difference_of_form(count: int) -> None:
    # A patch of 10 cm has a hundredth of the ball: 8 and 30 points, so 12 mm come to 4.2 and 2.2
    # mm.
    expected_m = 0.012 / np.sqrt(count / 100)
    assert form_error(SURFACE, ball(0.5, count, 1, 0.012), REACH_M) < 1.3 * expected_m


def test_bumps_are_told_where_the_mean_distance_is_that_of_a_ball() -> None:
    points = ball(0.5, 3000, 1)
    bumpy = points * (1 + 0.04 * np.sin(6 * np.arctan2(points[:, 1], points[:, 0])))[:, None]
    assert form_error(SURFACE, bumpy, REACH_M) > 0.010


def test_nothing_within_reach_is_no_form_at_all() -> None:
    assert form_error(SURFACE, ball(2.0, 100, 1), REACH_M) == np.inf


def test_the_side_that_estimated_normals_point_to_does_not_matter() -> None:
    signs = np.where(np.random.default_rng(2).random(len(SURFACE.normals)) < 0.5, -1.0, 1.0)
    flipped = Surface(SURFACE.points, SURFACE.normals * signs[:, None])
    points = ball(0.52, 3000, 1)
    assert form_error(flipped, points, REACH_M) == form_error(SURFACE, points, REACH_M)
