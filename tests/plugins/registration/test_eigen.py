"""Jacobi's eigenvectors against LAPACK's."""

import numpy as np
import pytest
from executive_plugins.registration.eigen import sorted_eigenvectors


@pytest.mark.parametrize("seed", range(20))
def test_agrees_with_lapack(seed: int) -> None:
    A = np.random.default_rng(seed).normal(size=(3, 3)) * 10.0 ** (seed % 7 - 3)
    A = A @ A.T
    values, vectors = sorted_eigenvectors(A)
    expected = np.linalg.eigh(A)[0][::-1]
    np.testing.assert_allclose(values, expected, rtol=1e-9, atol=1e-12 * expected[0])
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(vectors.T @ np.diag(values) @ vectors, A, atol=1e-12 * expected[0])


@pytest.mark.parametrize(
    "A", [np.zeros((3, 3)), np.eye(3), np.diag([1.0, 3.0, 2.0]), np.ones((3, 3))]
)
def test_bears_equal_and_vanishing_eigenvalues(A: np.ndarray) -> None:
    values, vectors = sorted_eigenvectors(A)
    assert (np.diff(values) <= 1e-15).all()
    np.testing.assert_allclose(vectors.T @ np.diag(values) @ vectors, A, atol=1e-14)
