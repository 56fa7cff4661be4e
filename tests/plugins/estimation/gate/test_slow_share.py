"""What a sensor declares and does not show as scatter is an error that changes slowly."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.slow_share import (
    PAIRS,
    follow_slowly,
    quiet_limits,
    slow_share,
    usual_sums,
)

PERIOD_S = 0.25


def shares(innovations: np.ndarray) -> np.ndarray:
    """Return the share after each innovation, given in standard deviations."""
    sums, counts, before = np.zeros(PAIRS), np.zeros(2, np.int64), np.zeros(3)
    bounds = quiet_limits(3, PERIOD_S), usual_sums(3)
    return np.array([slow_share(sums, counts, before, one, *bounds) for one in innovations])


@pytest.mark.parametrize("size", [1.0, 3.0])
def test_white_innovations_have_no_slow_share_whatever_they_exceed(size: float) -> None:
    white = size * np.random.default_rng(5).normal(size=(14_400, 3))  # an hour
    assert np.count_nonzero(shares(white)) <= 24  # of one false alarm until it has gone


def test_a_mean_of_any_size_is_no_scatter() -> None:
    noise = np.random.default_rng(6).normal(size=(40, 3))
    np.testing.assert_allclose(shares(noise + 50.0), shares(noise), atol=1e-9)


def test_an_error_that_stays_is_found_from_the_sixth_innovation_on() -> None:
    noise = 0.02 * np.random.default_rng(7).normal(size=(30, 3))
    found = shares(noise + np.array([0.7, 1.0, 0.5]))
    assert not found[:5].any()
    assert found[5:].min() > 0.99


def test_the_share_is_that_of_the_variance_by_its_upper_bound() -> None:
    """Scatter of 0.3 is 0.09 of the variance; of twelve pairs it is known to 24 % or less."""
    found = [
        shares(0.3 * np.random.default_rng(seed).normal(size=(24, 3)))[-1] for seed in range(40)
    ]
    assert np.mean(np.array(found) <= 1 - 0.09) > 0.85  # the upper bound of the scatter
    assert np.median(found) == pytest.approx(1 - 0.09 * 36 / usual_sums(3)[-1], abs=0.03)


def test_it_ends_with_the_first_innovations_that_scatter() -> None:
    rng = np.random.default_rng(8)
    quiet, white = 0.02 * rng.normal(size=(24, 3)), rng.normal(size=(8, 3))
    found = shares(np.concatenate([quiet, white]))
    assert found[23] > 0.99
    assert found[31] == 0.0


def test_a_state_follows_as_far_as_fixes_draw_it() -> None:
    assert follow_slowly(0.3, 0.0, 1.0) == pytest.approx(0.3)
    assert follow_slowly(0.3, 1.0, 1.0) == pytest.approx(1.0)
    assert follow_slowly(0.3, 0.5, 0.0) == pytest.approx(0.15)
