"""A sensor whose noise ends is frozen; one that never had any is not judged."""

import numpy as np
from executive_plugins.estimation.gate.frozen_samples import FrozenSamples

from executive.messages.imu import ImuSample


def lasts(rates):
    frozen = FrozenSamples()
    return [
        frozen.lasts_s(ImuSample(0.01 * k, "imu", np.array([x, 0.0, 0.0]), np.zeros(3)))
        for k, x in enumerate(rates)
    ]


def test_repeated_samples_are_counted_until_one_differs() -> None:
    np.testing.assert_allclose(lasts([1, 2, 2, 2, -0.0, 0.0, 3]), [0, 0, 0.01, 0.02, 0, 0.01, 0])


def test_a_sensor_without_noise_at_rest_is_not_frozen() -> None:
    assert lasts([0.0] * 5) == [0.0] * 5


def test_a_sensor_without_noise_that_comes_to_rest_is_not_frozen() -> None:
    """A dry run of the kinematic robot: its chassis turned, and stands."""
    up = np.array([0.0, 0.0, 9.81])
    for rest, is_frozen in ((1e-16, False), (1e-4, True)):
        frozen = FrozenSamples()
        rates = [0.2, 0.3, rest, rest, rest]
        samples = [ImuSample(0.01 * k, "imu", np.full(3, x), up) for k, x in enumerate(rates)]
        assert (max(map(frozen.lasts_s, samples)) > 0) == is_frozen
