"""A prediction that is wrong is told from fixes that are noisier than known."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_bias import InnovationBias

ROOT = np.array([[0.02, 0.0, 0.0], [0.01, 0.03, 0.0], [-0.02, 0.01, 0.05]])
ASIDE, ACROSS = np.array([0.6, 0.0, -0.8]), np.array([0.8, 0.0, 0.6])


def taken(white, period_s: float = 0.05) -> InnovationBias:
    """Return the test after innovations that are given in standard deviations."""
    bias = InnovationBias(3)
    for one in white:
        bias.add(ROOT @ one, ROOT @ ROOT.T, period_s)
    return bias


@pytest.mark.parametrize("factor", [0.3, 1.0, 5.0])
def test_noisy_fixes_do_not_make_the_prediction_wrong(factor: float) -> None:
    rng, bias = np.random.default_rng(1), InnovationBias(3)
    alarms = 0
    for _ in range(20_000):  # 1,000 s
        bias.add(rng.normal(0, factor * 0.01, 3), 1e-4 * np.eye(3), 0.05)
        alarms += bias.is_biased
    assert alarms <= (2 if factor <= 1.0 else 40)  # one an hour by the bound if noise is as known


@pytest.mark.parametrize(
    "leaning",
    [
        [5.0] * 6,  # there at once
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],  # grows evenly, as by a wrong velocity
        [0.1, 0.5, 1.2, 2.4, 4.2, 7.0],  # and faster, as by a wrong acceleration
        [0.0] * 20 + [1.6] * 24,  # too small to show in six
    ],
)
def test_innovations_that_lean_make_it_wrong(leaning: list[float]) -> None:
    rng = np.random.default_rng(2)
    assert taken([x * ASIDE + 0.3 * rng.normal(0, 1, 3) for x in leaning]).is_biased


@pytest.mark.parametrize(
    "white",
    [
        [7.0 * sign * ASIDE for sign in (1, -1) * 6],  # large, to both sides
        [9.0 * sign * ASIDE + 5.0 * ACROSS for sign in (1, -1) * 3],  # leans less than it scatters
        [5.0 * ASIDE] * 5,  # too few
        [1.5 * ASIDE] * 6,  # by chance
        [*[5.0 * ASIDE] * 5, np.full(3, np.nan)],  # what is unknown does not count
    ],
)
def test_others_do_not(white) -> None:
    assert not taken(white).is_biased


def test_a_lean_is_the_newest_innovation_without_its_noise() -> None:
    rng, errors = np.random.default_rng(3), []
    for _ in range(300):
        lean = taken([(2.0 + k) * ASIDE + rng.normal(0, 1, 3) for k in range(6)]).lean
        assert lean is not None
        assert lean.lasts == 6
        error = np.linalg.solve(ROOT, lean.innovation) - 7.0 * ASIDE
        errors.append(error / np.sqrt(lean.share))
    # A line through six points is known at its end to 11/21 of the variance of one.
    assert lean.share == pytest.approx(11 / 21)
    assert np.mean(np.square(errors)) == pytest.approx(1.0, abs=0.15)


def test_what_has_been_explained_is_forgotten() -> None:
    bias = taken([5.0 * ASIDE] * 6)
    bias.clear()
    assert not bias.is_biased
    bias.add(ROOT @ (5.0 * ASIDE), ROOT @ ROOT.T, 0.05)
    assert not bias.is_biased


def test_white_innovations_make_it_right_again() -> None:
    rng = np.random.default_rng(1)
    assert not taken([*[5.0 * ASIDE] * 6, *rng.normal(0, 1, (48, 3))]).is_biased


def test_the_rarer_fixes_are_the_less_a_lean_has_to_be() -> None:
    white = [2.45 * ASIDE] * 6
    assert not taken(white, 0.02).is_biased
    assert taken(white, 2.0).is_biased
