"""White noise is told from samples of a body that moves."""

import numpy as np
import pytest
from executive_plugins.estimation.calibration.sample_noise import white_noise

from executive.arrays import Float

STD = 0.02


def samples(count: int, motion: Float | float = 0.0, seed: int = 0) -> Float:
    return np.asarray(np.random.default_rng(seed).normal(0.0, STD, (count, 3)) + motion)


def motion(count: int) -> Float:
    """Return a swing of 1 Hz at 100 Hz, fifty times as large as the noise."""
    t = np.arange(count)[:, None] / 100
    return np.asarray(50 * STD * np.sin(2 * np.pi * t + np.arange(3)))


@pytest.mark.parametrize("moves", [False, True])
def test_the_deviation_is_that_of_the_noise_whatever_the_body_does(moves: bool) -> None:
    told = white_noise(samples(20_000, motion(20_000) if moves else 0.0))
    assert told is not None
    std, doubt = told
    assert std == pytest.approx(STD, abs=4 * doubt)
    assert 0.0 < doubt < 0.02 * STD


def test_its_doubt_is_the_scatter_over_recordings() -> None:
    told = [white_noise(samples(8000, seed=seed)) for seed in range(60)]
    stds, doubts = np.array([one for one in told if one is not None]).T
    assert len(stds) == 60
    assert np.std(stds) == pytest.approx(doubts.mean(), rel=0.3)


def test_some_windows_that_shake_do_not_count() -> None:
    shaken = samples(4000)
    shaken[1000:1800] *= 30.0
    told = white_noise(shaken)
    assert told is not None
    assert told[0] == pytest.approx(STD, rel=0.05)


@pytest.mark.parametrize(("count", "is_enough"), [(0, False), (399, False), (400, True)])
def test_two_windows_of_two_hundred_samples_are_needed(count: int, is_enough: bool) -> None:
    assert (white_noise(samples(count)) is not None) is is_enough
