"""The level of swaying values: as sure as it says, and at once where nothing sways."""

import numpy as np
import pytest

from executive.leaf.sway import PERIODS_S, level

_TICK_S, _NOISE = 0.05, 30.0


def swaying(rng, seconds, amplitude, period_s=None):
    """Return times and values about 2,000 that begin at any place of a swing."""
    damping = rng.uniform(0.0, 0.1)
    times = 100.0 + np.arange(round(seconds / _TICK_S)) * _TICK_S
    turns = 2 * np.pi * (times - 100.0) / (period_s or rng.uniform(0.6, 1.6))
    wave = np.exp(-damping * turns) * np.cos(turns + rng.uniform(0, 2 * np.pi))
    return times, 2000.0 + amplitude * wave + _NOISE * rng.standard_normal(len(times))


@pytest.mark.parametrize("amplitude", [0.0, 60.0, 200.0, 500.0])
@pytest.mark.parametrize("seconds", [0.4, 0.8, 1.2])
def test_levels_are_as_sure_as_they_say(seconds, amplitude):
    """Damping and periods lie between those that the models know, which are 8 % apart.

    Of 100 draws 95 are expected within two standard deviations, 86 at least by 99.98 %.
    """
    rng = np.random.default_rng(3)
    found = [level(*swaying(rng, seconds, amplitude)) for _ in range(100)]
    off = np.array([abs(mean - 2000.0) / std for mean, std in found])
    assert np.mean(off < 2.0) > 0.85
    assert np.mean(off < 4.0) > 0.95


def test_most_of_a_swing_tells_the_level_where_its_mean_does_not():
    rng = np.random.default_rng(4)
    drawn = [swaying(rng, 0.9, 500.0, period_s=1.1) for _ in range(50)]
    means = np.array([values.mean() - 2000.0 for _, values in drawn])
    levels = np.array([level(*one)[0] - 2000.0 for one in drawn])
    assert np.sqrt(np.mean(means**2)) > 2 * np.sqrt(np.mean(levels**2))


def test_a_third_of_a_swing_leaves_the_level_open():
    times, values = swaying(np.random.default_rng(5), 0.4, 400.0, period_s=1.2)
    _, std = level(times, values)
    assert std > 5 * _NOISE / np.sqrt(len(values))


def test_values_at_rest_are_as_sure_as_their_mean():
    rng = np.random.default_rng(6)
    times, values = swaying(rng, 0.8, 0.0)
    mean, std = level(times, values)
    assert mean == pytest.approx(values.mean(), abs=_NOISE / np.sqrt(len(values)))
    assert std < 2 * _NOISE / np.sqrt(len(values))


def test_equal_values_are_known_without_error():
    assert level(np.arange(8) * _TICK_S, np.full(8, 900.0)) == (900.0, 0.0)


def test_few_values_say_nothing_of_a_sway():
    mean, std = level(np.arange(4) * _TICK_S, np.array([1.0, 2.0, 3.0, 4.0]))
    assert (mean, std) == (2.5, float("inf"))


def test_a_sway_slower_than_any_known_one_is_not_trusted():
    """A value that falls steadily has no level; what is told lies far apart from its mean."""
    times = np.arange(10) * _TICK_S
    values = 2000.0 - 1500.0 * times + np.random.default_rng(7).standard_normal(10)
    assert level(times, values)[1] > 50.0
    assert times[-1] < PERIODS_S[-1] / 4
