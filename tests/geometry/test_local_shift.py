"""A survey that lies some centimetres off a map, by differing amounts over the site."""

import numpy as np
import pytest

from executive.geometry.local_shift import local_shift

STD_M, WIDTH_M, NOISE_M = 0.04, 0.75, 0.01
MIDDLES = np.array([[2.0, 2.0, 0.4], [6.0, 3.0, 0.4], [3.0, 6.5, 0.4]])  # of boulders
RADIUS_M = 0.6


def site(spacing_m, seed):
    """Return level ground and upper halves of boulders, with noise, shape (N, 3)."""
    rng = np.random.default_rng(seed)
    x, y = (a.ravel() for a in np.meshgrid(*[np.arange(0.0, 9.0, spacing_m)] * 2))
    z = np.zeros(len(x))
    for middle in MIDDLES:
        square = RADIUS_M**2 - (x - middle[0]) ** 2 - (y - middle[1]) ** 2
        z = np.maximum(z, np.where(square > 0, middle[2] + np.sqrt(np.maximum(square, 0)), 0.0))
    flank = []
    for middle in MIDDLES:
        turn, height = rng.uniform(0, 2 * np.pi, 1500), rng.uniform(0.05, middle[2], 1500)
        flank.append(
            np.c_[RADIUS_M * np.cos(turn) + middle[0], RADIUS_M * np.sin(turn) + middle[1], height]
        )
    points = np.vstack([np.c_[x, y, z], *flank])
    return points + rng.normal(0, NOISE_M, points.shape)


def on_boulders(points):
    return np.linalg.norm(points[:, None] - MIDDLES, axis=2).min(axis=1) < RADIUS_M + 0.1


def off_m(found, survey, warp):
    """Return the root mean square of what is left of a warp on the boulders [m]."""
    rows = on_boulders(survey)
    left = found.at(survey[rows]) + warp[rows]
    return float(np.sqrt((left**2).sum(axis=1).mean()))


@pytest.mark.parametrize("shift", [(0.03, -0.02, 0.04), (0.0, 0.0, -0.05), (0.05, 0.0, 0.0)])
def test_a_constant_shift_is_taken_back_where_boulders_tell_of_it(shift):
    reference, survey = site(0.05, 0), site(0.04, 1)
    warp = np.tile(shift, (len(survey), 1))
    found = local_shift(survey + warp, reference, STD_M, WIDTH_M)
    assert off_m(found, survey + warp, warp) < 0.003
    assert found.share > 0.95


def test_a_tilt_and_a_bend_are_followed_over_the_site():
    reference, survey = site(0.05, 0), site(0.04, 1)
    warp = np.zeros_like(survey)
    warp[:, 2] = 0.006 * (survey[:, 0] - 4.5)  # a tilt of 6 mrad: 2.7 cm at the border
    warp[:, 0] = 0.02 * np.sin(2 * np.pi * survey[:, 1] / 10.0)
    before = np.sqrt((warp[on_boulders(survey)] ** 2).sum(axis=1).mean())
    found = local_shift(survey + warp, reference, STD_M, WIDTH_M)
    assert off_m(found, survey + warp, warp) < 0.4 * before
    far = found.at(np.array([[0.2, 4.5, 0.0], [8.8, 4.5, 0.0]]))
    assert far[:, 2] == pytest.approx([0.025, -0.025], abs=0.008)


def test_sides_that_the_map_does_not_show_do_not_pull_the_survey():
    reference, survey = site(0.05, 0), site(0.04, 1)
    # The map shows what one lidar at x = -5 m sees of the boulders.
    hidden = on_boulders(reference) & (
        reference[:, 0]
        > MIDDLES[np.argmin(np.linalg.norm(reference[:, None] - MIDDLES, axis=2), 1), 0]
    )
    found = local_shift(survey, reference[~hidden], STD_M, WIDTH_M)
    assert off_m(found, survey, np.zeros_like(survey)) < 0.008


def test_what_nothing_tells_of_keeps_its_place():
    ground, again = (one[~on_boulders(one)] for one in (site(0.05, 0), site(0.05, 1)))
    found = local_shift(again + [0.03, 0.0, 0.03], ground, STD_M, WIDTH_M).at(
        np.array([[4.5, 1.0, 0.0]])
    )
    assert found[0, 2] == pytest.approx(-0.03, abs=0.004)
    assert abs(found[0, 0]) < 0.004  # level ground tells nothing of x


@pytest.mark.parametrize("reference", [np.zeros((0, 3)), np.ones((5, 3)), site(0.1, 0) + 100.0])
def test_without_a_common_surface_nothing_is_shifted(reference):
    survey = site(0.1, 1)
    found = local_shift(survey, reference, STD_M, WIDTH_M)
    assert found.share == 0.0
    assert found.at(survey) == pytest.approx(np.zeros((len(survey), 3)))


def test_an_empty_survey_has_no_shifts():
    found = local_shift(np.zeros((0, 3)), site(0.1, 0), STD_M, WIDTH_M)
    assert found.at(np.zeros((0, 3))).shape == (0, 3)
    assert found.share == 0.0
