"""A prediction that is wrong is told from fixes that are noisier than they declare."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_bias import InnovationBias
from scipy.stats import beta, chi2


@pytest.mark.parametrize("factor", [1.0, 5.0])
def test_noisy_fixes_do_not_make_the_prediction_wrong(factor: float) -> None:
    rng, bias = np.random.default_rng(1), InnovationBias(3)
    alarms = 0
    for _ in range(20_000):  # 1,000 s
        bias.add(rng.normal(0, factor * 0.01, 3), 1e-4 * np.eye(3), 0.05)
        alarms += bias.is_biased
    assert alarms <= 2  # one an hour by its bound


def test_innovations_that_lean_to_one_side_make_it_wrong_and_white_ones_right_again() -> None:
    rng, bias = np.random.default_rng(1), InnovationBias(3)
    for _ in range(6):
        bias.add(rng.normal(0, 0.01, 3) + [0.05, 0.0, 0.0], 1e-4 * np.eye(3), 0.05)
    assert bias.is_biased
    for _ in range(6):
        bias.add(rng.normal(0, 0.01, 3), 1e-4 * np.eye(3), 0.05)
    assert not bias.is_biased


# Of a period of 0.1 s the next power of two is 1/16 s: one chance in an hour.
CHANCE = 0.0625 / 3600
FAR = np.sqrt(chi2.isf(CHANCE, 3) / 6)  # in standard deviations, of six alike
ONE_SIDED = beta.ppf(1 - CHANCE, 3 / 2, 3 * 5 / 2)
ROOT = np.array([[0.02, 0.0, 0.0], [0.01, 0.03, 0.0], [-0.02, 0.01, 0.05]])


def leaning(white: list[np.ndarray], period_s: float = 0.1) -> list[bool]:
    """Return the answers after each innovation, given in standard deviations."""
    bias, found = InnovationBias(3), []
    for one in white:
        bias.add(ROOT @ one, ROOT @ ROOT.T, period_s)
        found.append(bias.is_biased)
    return found


ASIDE, ACROSS = np.array([0.6, 0.0, -0.8]), np.array([0.8, 0.0, 0.6])


@pytest.mark.parametrize(("factor", "is_biased"), [(0.999, False), (1.001, True)])
def test_six_that_lean_farther_than_chance_are_needed(factor: float, is_biased: bool) -> None:
    assert leaning([factor * FAR * ASIDE] * 6) == [False] * 5 + [is_biased]
    unknown = np.full(3, np.nan)
    assert leaning([factor * FAR * ASIDE] * 5 + [unknown]) == [False] * 6
    # What is older than six is forgotten.
    assert leaning([factor * FAR * ASIDE] * 6 + [np.zeros(3)])[-1] is False
    assert leaning([-9 * ASIDE] + [factor * FAR * ASIDE] * 6)[-1] == is_biased


@pytest.mark.parametrize(("factor", "is_biased"), [(0.99, True), (1.01, False)])
def test_noise_that_is_larger_than_declared_must_lean_by_its_own_size(
    factor: float, is_biased: bool
) -> None:
    """The share of the squared mean in the mean of squares counts, however large all are."""
    lean, noise = 10.0, 10.0 * np.sqrt(1 / ONE_SIDED - 1)
    white = [lean * ASIDE + factor * noise * sign * ACROSS for sign in (1, -1) * 3]
    assert leaning(white)[-1] == is_biased


def test_the_rarer_fixes_are_the_less_a_lean_has_to_be() -> None:
    white = [0.999 * FAR * ASIDE] * 6
    assert leaning(white, 0.1)[-1] is False
    assert leaning(white, 0.2)[-1] is True
