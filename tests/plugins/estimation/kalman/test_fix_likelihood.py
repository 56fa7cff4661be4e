"""The likelihood of a fix against the density of a Gaussian."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_likelihood import log_likelihood, scaled_distance2

Z = np.zeros(3)
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
FIX = Fix(0.0, "antenna", Z, np.array([0.02, -0.01, 0.05]), np.diag([1e-4, 1e-4, 4e-4]))


def body(variance: float) -> ErrorStateFilter:
    sample = Inertial(0.0, Z, np.array([0.0, 0.0, 9.81]), 0.01)
    P = np.diag(np.repeat([1e-6, 1e-4, variance, 1e-8, 1e-6], 3))
    return ErrorStateFilter(InertialState(sample, np.eye(3), Z, Z, Z, Z), P, NOISE)


@pytest.mark.parametrize("scale", [1.0, 9.0])
def test_it_is_the_density_of_the_innovation_but_for_a_constant(scale: float) -> None:
    block = body(3e-4).block
    distance2 = scaled_distance2(block, FIX, scale, 0.0)
    # The antenna is at the sensor: covariances of independent axes add up.
    variances = 3e-4 + scale * np.diag(FIX.covariance)
    assert distance2 == pytest.approx(np.sum(FIX.p_map_antenna**2 / variances))
    density = -0.5 * (distance2 + np.log(variances).sum())
    assert log_likelihood(block) == pytest.approx(density)


@pytest.mark.parametrize("variance", [np.inf, np.nan, -1.0])
def test_a_filter_that_diverged_makes_no_fix_likely(variance: float) -> None:
    block = body(3e-4).block
    scaled_distance2(block, FIX, 1.0, 0.0)
    block["predicted"][0, 4] = variance
    assert log_likelihood(block) == -np.inf
