"""A rate that is averaged for as long as it is steady."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.inertial.steady_rate import SteadyRate

DENSITY, RATE_HZ = 1e-3, 200
NOISE = InertialNoise(DENSITY, 1e-3, 1e-5, 1e-4, 0.03, 9.81, 1e-3)


def steady(rate, noise: float = 1.0) -> SteadyRate:
    """Return means of two seconds of a rate about z, a function of time."""
    samples, rng = SampleBuffer(), np.random.default_rng(4)
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


@pytest.mark.parametrize("at_s", [-1.0, 0.0, 1.995, 3.0])
def test_at_the_ends_few_samples_are_left(at_s: float) -> None:
    assert steady(lambda _: 0.3, noise=0.0).at(at_s) == pytest.approx([0.0, 0.0, 0.3])


def test_one_sample_is_its_own_mean() -> None:
    samples = SampleBuffer()
    samples.append(Inertial(1.0, np.array([0.1, 0.2, 0.3]), np.zeros(3), 0.01))
    assert SteadyRate(samples, NOISE).at(1.0) == pytest.approx([0.1, 0.2, 0.3])
