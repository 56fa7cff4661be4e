"""A rate that is averaged for as long as it is steady."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.inertial.steady_rate import SteadyRate

from executive.geometry.rotation import from_rpy

DENSITY, RATE_HZ = 1e-3, 200
NOISE = InertialNoise(DENSITY, 1e-3, 1e-5, 1e-4, 0.03, 9.81, 1e-3)


def steady(rate, noise: float = 1.0, seed: int = 4) -> SteadyRate:
    """Return means of two seconds of a rate about z, a function of time."""
    samples, rng = SampleBuffer(), np.random.default_rng(seed)
    for k in range(2 * RATE_HZ):
        at_s = k / RATE_HZ
        error = noise * rng.normal(0.0, DENSITY * RATE_HZ**0.5, 3)
        turn = [0.0, 0.0, rate(at_s - 0.5 / RATE_HZ)]  # a sample is the mean since the last
        samples.append(Inertial(at_s, error + turn, np.zeros(3), 1 / RATE_HZ))
    return SteadyRate(samples, NOISE)


def test_noise_of_an_even_rate_is_averaged_out() -> None:
    found = steady(lambda _: 0.3)
    errors = [found.at(at_s) - [0.0, 0.0, 0.3] for at_s in np.arange(0.3, 1.7, 0.05)]
    # The mean is as good as that of six samples, though chance ends it early now and then.
    assert np.sqrt(np.mean(np.square(errors))) < 0.4 * DENSITY * RATE_HZ**0.5


@pytest.mark.parametrize("hz", [2.0, 5.0])
def test_a_swing_is_followed(hz: float) -> None:
    found = steady(lambda at_s: 2.0 * np.sin(2 * np.pi * hz * at_s), noise=0.0)
    for at_s in np.arange(0.3, 1.7, 0.01):
        assert found.at(at_s)[2] == pytest.approx(2.0 * np.sin(2 * np.pi * hz * at_s), abs=0.1)


def test_near_the_newest_sample_those_before_it_are_averaged() -> None:
    """A fix is as new as the samples: what comes after it is not there yet."""
    errors = [steady(lambda _: 0.3, seed=seed).at(1.99) - [0.0, 0.0, 0.3] for seed in range(20)]
    assert np.sqrt(np.mean(np.square(errors))) < 0.4 * DENSITY * RATE_HZ**0.5
    begins = steady(lambda at_s: 3.0 * max(0.0, at_s - 1.9))
    assert begins.at(1.99)[2] == pytest.approx(0.27, abs=3 * DENSITY * RATE_HZ**0.5)


def test_samples_about_one_time_say_the_same_of_it() -> None:
    samples, rng = SampleBuffer(), np.random.default_rng(5)
    for k in range(4 * RATE_HZ):
        samples.append(Inertial(k / RATE_HZ, rng.normal(0.0, 0.01, 3), np.zeros(3), 1 / RATE_HZ))
    everything, near = SteadyRate(samples, NOISE), SteadyRate(samples, NOISE, 2.0)
    assert near.at(2.0) == pytest.approx(everything.at(2.0))


def test_an_antenna_moves_with_the_steady_rate() -> None:
    z = np.zeros(3)
    state = InertialState(Inertial(1.0, z, z, 0.0), from_rpy(0, 0, np.pi / 2), z, z + 1.0, z, z)
    speed = steady(lambda _: 0.3, noise=0.0).speed(state, np.array([2.0, 0.0, 0.0]))
    assert speed == pytest.approx([1.0 - 0.6, 1.0, 1.0])


@pytest.mark.parametrize("at_s", [-1.0, 0.0, 1.995, 3.0])
def test_at_the_ends_few_samples_are_left(at_s: float) -> None:
    assert steady(lambda _: 0.3, noise=0.0).at(at_s) == pytest.approx([0.0, 0.0, 0.3])


def test_one_sample_is_its_own_mean() -> None:
    samples = SampleBuffer()
    samples.append(Inertial(1.0, np.array([0.1, 0.2, 0.3]), np.zeros(3), 0.01))
    assert SteadyRate(samples, NOISE).at(1.0) == pytest.approx([0.1, 0.2, 0.3])
