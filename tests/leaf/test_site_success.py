"""The chance of an attempt, after what came of those before it on the site."""

import numpy as np
import pytest

from executive.leaf.site_success import expected_success


def test_a_new_site_is_one_of_any_kind():
    assert expected_success(0.5, []) == pytest.approx(0.75, abs=0.02)
    assert expected_success(0.95, []) == pytest.approx(0.93, abs=0.02)


def test_a_grasp_that_holds_more_often_is_likelier():
    chances = [expected_success(rate, [(0.7, True)]) for rate in np.linspace(0.1, 0.9, 9)]
    assert np.all(np.diff(chances) > 0.01)


def test_a_site_that_keeps_failing_is_expected_to_fail():
    before = expected_success(0.9, [])
    assert expected_success(0.9, [(0.9, False)] * 5) < before - 0.2
    assert expected_success(0.9, [(0.9, True)] * 5) > before + 0.02


def test_a_failure_of_a_poor_grasp_says_less_than_that_of_a_sound_one():
    assert expected_success(0.9, [(0.1, False)]) > expected_success(0.9, [(0.95, False)])


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_no_rate_is_certain(rate):
    assert 0.1 < expected_success(rate, []) < 0.98


def test_thousands_of_attempts_are_no_loss_of_number():
    past = [(0.9, number % 5 > 0) for number in range(5000)]
    assert expected_success(0.9, past) == pytest.approx(0.8, abs=0.02)


def test_it_learns_the_rate_of_sites_that_it_was_not_fitted_to():
    """Over sites that hold twice and half as often, what is expected comes near to what is."""
    rng = np.random.default_rng(5)
    gaps = []
    for odds in (0.5, 8.0):
        chance = odds / (1 + odds)
        past = [(0.85, bool(rng.uniform() < chance)) for _ in range(200)]
        before, after = expected_success(0.85, []), expected_success(0.85, past)
        gaps.append((abs(before - chance), abs(after - chance)))
    assert all(after < 0.06 for _, after in gaps)
    assert max(before for before, _ in gaps) > 0.3
