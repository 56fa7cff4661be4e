"""A prediction that runs away is told from fixes that have jumped, drift or scatter."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.growing_refusals import GrowingRefusals

ASIDE = np.array([0.6, 0.8, 0.0])


NOISE = 1e-4 * np.eye(3)


def _says(innovations) -> bool:
    refusals = GrowingRefusals()
    said = False
    for innovation in innovations:
        said = refusals.is_running_away(np.asarray(innovation, dtype=float), NOISE)
    return said


def test_a_growing_error_of_acceleration_is_a_prediction_that_runs_away() -> None:
    assert _says(0.1 * t**2 * ASIDE for t in (1, 2, 3))
    assert _says(0.1 * t**2 * ASIDE for t in np.arange(1.0, 3.0, 0.05))  # at 20 Hz


@pytest.mark.parametrize(
    "innovations",
    [
        [ASIDE] * 5,  # jumped
        [(5 + 0.01 * t**2) * ASIDE for t in range(9)],  # jumped, while the prediction drifts
        [0.5 * t * ASIDE for t in range(1, 8)],  # drifts evenly
        [ASIDE, -4 * ASIDE, 9 * ASIDE],  # scatters
        [ASIDE, 4 * ASIDE],  # too few
    ],
)
def test_other_refusals_are_none(innovations) -> None:
    assert not _says(innovations)


def test_a_prediction_that_runs_away_after_fixes_came_back_is_seen() -> None:
    """The first refusals are of the jump, to another side."""
    across = np.array([0.8, -0.6, 0.0])
    row = [across, *(0.1 * t**2 * ASIDE for t in np.arange(1.0, 9.0))]
    assert any(_says(row[:count]) for count in range(1, 10))
    row = [across, *[3 * ASIDE] * 14]
    assert not any(_says(row[:count]) for count in range(1, 16))


def test_a_fix_that_was_used_ends_the_row() -> None:
    refusals = GrowingRefusals()
    assert not refusals.is_running_away(ASIDE, NOISE)
    assert not refusals.is_running_away(4 * ASIDE, NOISE)
    refusals.clear()
    assert not refusals.is_running_away(9 * ASIDE, NOISE)


@pytest.mark.parametrize("scale", [0.3, 1.0, 30.0])
def test_growth_is_relative_to_the_first_refusal(scale: float) -> None:
    """Threefold in all, whatever the size of the errors."""
    for last, says in ((2.9, False), (3.1, True)):
        assert _says(scale * size * ASIDE for size in (1.0, 1.2, last)) is says


@pytest.mark.parametrize(("off_deg", "says"), [(35.0, True), (38.0, False), (145.0, False)])
def test_refusals_point_to_one_side_up_to_37_degrees(off_deg: float, says: bool) -> None:
    turned = np.array([np.cos(np.radians(off_deg)), np.sin(np.radians(off_deg)), 0.0])
    ahead = np.array([1.0, 0.0, 0.0])
    for first, middle in ((turned, 2 * ahead), (ahead, 2 * turned)):
        assert _says([first, middle, 9 * ahead]) is says


@pytest.mark.parametrize(("noise_m", "says"), [(0.15, True), (0.6, False)])
def test_a_bend_that_noise_explains_is_none(noise_m: float, says: bool) -> None:
    """Of 2 m: the noise of three fixes has √6 times the deviation of one, and a bound of 4.6."""
    refusals, said = GrowingRefusals(), False
    for t in (1, 2, 3):
        said = refusals.is_running_away(t**2 * ASIDE, noise_m**2 * np.eye(3))
    assert said is says


def test_the_middle_one_is_as_far_from_both_ends() -> None:
    """Of an even number, the newest waits for the next one."""
    assert _says([*(t**2 * ASIDE for t in (1, 2, 3)), -ASIDE])
    assert not _says([*(t**2 * ASIDE for t in (1, 2, 3)), 16 * ASIDE, -ASIDE])
    assert _says([*(t**2 * ASIDE for t in (1, 2, 3, 4, 5, 6))])


def test_a_row_that_grew_is_not_forgotten_however_long_it_lasts() -> None:
    assert _says([*(t**2 * ASIDE for t in range(1, 700))])
