"""Innovations in standard deviations, against NumPy."""

import numpy as np
import pytest
from executive_plugins.estimation.cholesky import squared_distance, whitened


@pytest.mark.parametrize("size", [1, 3, 6])
def test_an_innovation_is_whitened_by_the_root_of_its_covariance(size: int) -> None:
    rng = np.random.default_rng(size)
    root, innovation = rng.normal(0, 1, (size, size)), rng.normal(0, 1, size)
    S = root @ root.T + 0.1 * np.eye(size)
    found = whitened(S, innovation)
    assert found is not None
    white, L, distance2 = found
    np.testing.assert_allclose(L, np.linalg.cholesky(S), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(L @ white, innovation, rtol=1e-12, atol=1e-14)
    assert distance2 == pytest.approx(innovation @ np.linalg.solve(S, innovation), rel=1e-10)
    assert squared_distance(S, innovation) == distance2


@pytest.mark.parametrize(
    ("covariance", "innovation"),
    [
        (np.diag([1.0, -1.0]), np.ones(2)),
        (np.zeros((2, 2)), np.ones(2)),
        (np.full((2, 2), np.nan), np.ones(2)),
        (np.eye(2), np.array([np.nan, 0.0])),
        (np.eye(2), np.array([0.0, np.inf])),
    ],
)
def test_what_has_no_distance_is_infinitely_far(covariance, innovation) -> None:
    assert whitened(covariance, innovation) is None
    assert squared_distance(covariance, innovation) == float("inf")
