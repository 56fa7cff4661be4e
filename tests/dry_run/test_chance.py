"""What no file mocks is drawn with the probabilities that the command tells."""

import math

import numpy as np
import pytest

from executive.dry_run.chance import Chance

DRAWS = 4000
SPREAD = 4 * 0.5 / math.sqrt(DRAWS)  # four standard deviations of a share, at the most


def share(draw):
    rng = np.random.default_rng(5)
    return np.mean([draw(rng) for _ in range(DRAWS)])


@pytest.mark.parametrize("failures", [0.0, 0.1, 0.7, 1.0])
def test_as_many_actions_fail_as_is_told(failures):
    chance = Chance(1, failures)
    assert share(chance.fails) == pytest.approx(failures, abs=SPREAD)
    assert f"an action fails with probability {failures:g} " in chance.told()


def test_by_default_one_action_in_ten_fails():
    assert Chance().failures == 0.1
    assert Chance().seed == 1


def test_half_of_all_answers_are_yes_and_half_of_the_failures_below_a_timeout_hang():
    chance = Chance()
    assert share(chance.holds) == pytest.approx(0.5, abs=SPREAD)
    assert share(chance.hangs) == pytest.approx(0.5, abs=SPREAD)
    assert "a condition holds with probability 0.5" in chance.told()


def drawn(limit_s=math.inf):
    rng = np.random.default_rng(5)
    return np.array([Chance().duration_s(rng, limit_s) for _ in range(DRAWS)])


def test_durations_lie_between_half_a_second_and_fifty_with_equal_weight_for_each_factor():
    durations_s = drawn()
    assert durations_s.min() >= 0.5
    assert durations_s.max() <= 50.0
    for tenth, expected_s in ((1, 0.5 * 100**0.1), (5, 5.0), (9, 0.5 * 100**0.9)):
        assert np.quantile(durations_s, tenth / 10) == pytest.approx(expected_s, rel=0.2)
    assert "takes 0.5 to 50 s" in Chance().told()


def test_below_a_timeout_an_action_takes_at_most_half_of_its_limit():
    assert 0.5 <= drawn(20.0).min() < 0.6
    assert 9.0 < drawn(20.0).max() <= 10.0
    assert drawn(0.4) == pytest.approx(0.2)  # shorter than the shortest
    assert drawn(300.0).max() <= 50.0
