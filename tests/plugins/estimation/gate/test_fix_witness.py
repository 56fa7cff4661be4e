"""Fixes tell by which error of a state they are explained, before one is proven."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.fix_witness import FixWitness
from executive_plugins.estimation.gate.likely_error import BEGINS_AFTER_S, likely_error

EAST = np.array([1.0, 0.0, 0.0])
NONE = np.zeros((0, 3))


def test_an_error_counts_by_its_probability() -> None:
    """Held against Bayes' rule, with the likelihoods of both hypotheses written out."""
    covariance, apart = np.diag([4.0, 1.0, 0.25]), np.array([7.0, 1.0, -1.0])
    squares = float(apart @ np.linalg.inv(covariance) @ apart) / 3
    likelihoods = [np.exp(-0.5 * 3 * squares / factor) / factor**1.5 for factor in (1.0, squares)]
    prior = 60.0 / BEGINS_AFTER_S
    probability = prior * likelihoods[1] / np.dot([1 - prior, prior], likelihoods)
    share = 1 - 1 / squares
    expected = probability * (share**2 * np.outer(apart, apart) + share * covariance)
    np.testing.assert_allclose(likely_error(apart, covariance, 60.0), expected)


@pytest.mark.parametrize("lasts_s", [0.0, 1.0, 1e9])
def test_what_chance_explains_is_no_error(lasts_s: float) -> None:
    assert not likely_error(np.array([1.0, -1.0, 0.9]), np.eye(3), lasts_s).any()


def test_what_says_nothing_is_no_error() -> None:
    assert not likely_error(EAST, np.zeros((3, 3)), 1.0).any()
    assert not likely_error(np.full(3, np.nan), np.eye(3), 1.0).any()
    witness = FixWitness(3, 10.0)
    witness.take(EAST, np.zeros((3, 3)), NONE, 1.0)
    witness.use(0.0)
    assert witness.moved2 is None


def test_a_fix_far_away_is_held_until_three_later_ones_agree() -> None:
    witness = FixWitness(3, 10.0)
    witness.take(20.0 * EAST, np.eye(3), NONE, 1.0)
    assert witness.moved2 is not None
    assert 19.0**2 < witness.moved2[0, 0] < 21.0**2
    assert witness.moved2[1, 1] <= 1.0
    for _ in range(2):
        witness.take(0.1 * EAST, np.eye(3), NONE, 1.0)
        assert witness.moved2 is not None
    witness.take(0.1 * EAST, np.eye(3), NONE, 1.0)
    assert witness.moved2 is None


def test_a_fix_that_was_used_is_held_for_a_time() -> None:
    """The state has followed it, so that later ones agree whichever of both was wrong."""
    witness = FixWitness(3, 10.0)
    for now_s, off_m in ((0.0, 20.0), (1.0, 10.0)):
        witness.take(off_m * EAST, np.eye(3), NONE, 1.0)
        witness.use(now_s)
    witness.use_sound(6, 9.9)
    assert witness.moved2 is not None
    assert witness.moved2[0, 0] > 19.0**2
    witness.use_sound(1, 10.1)
    assert witness.moved2 is not None
    assert 9.0**2 < witness.moved2[0, 0] < 11.0**2
    witness.use_sound(1, 11.1)
    assert witness.moved2 is None


def test_innovations_that_are_usual_one_by_one_show_an_error_together() -> None:
    white = np.tile(1.5 * EAST, (48, 1))
    found = []
    for count in (1, 12, 48):
        witness = FixWitness(3, 10.0)
        witness.take(3.0 * EAST, 4.0 * np.eye(3), white[:count], 0.2)
        found.append(0.0 if witness.moved2 is None else witness.moved2[0, 0])
    assert found[0] < found[1] < found[2]
    assert found[0] == 0.0
    assert found[2] == pytest.approx(3.0**2, rel=0.1)


def test_another_witness_begins_with_what_was_used_and_one_that_is_cleared_with_nothing() -> None:
    witness, other = FixWitness(3, 10.0), FixWitness(3, 10.0)
    other.take(20.0 * EAST, np.eye(3), NONE, 1.0)
    witness.begin(other)
    assert witness.moved2 is None
    other.use(5.0)
    witness.begin(other)
    np.testing.assert_allclose(witness.moved2, other.moved2)
    witness.clear()
    assert witness.moved2 is None
