"""The compiled correction against the plain equations."""

import numpy as np
import pytest
from executive_plugins.estimation.kalman.compiled_correction import correct_into


def problem(n: int, m: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    A, B = rng.normal(0, 0.1, (n, n)), rng.normal(0, 0.1, (m, m))
    P, noise = A @ A.T + 1e-4 * np.eye(n), B @ B.T + 1e-3 * np.eye(m)
    return P, rng.normal(0, 1, (m, n)), rng.normal(0, 0.1, m), noise


def corrected(P, H, residual, noise, gate):
    """Return covariance and error after a correction; None beyond the gate."""
    (m, n), error = H.shape, np.empty(H.shape[1])
    W, L, after = np.empty((m, n + 1)), np.empty((m, m)), np.empty((n, n))
    distance2 = correct_into(P, H, residual, noise, gate, W, L, after, error)
    return (after, error) if distance2 <= gate else None


@pytest.mark.parametrize(("n", "m"), [(15, 3), (21, 3), (21, 6), (15, 1)])
def test_it_is_the_conditional_of_the_joint_distribution(n, m) -> None:
    P, H, residual, noise = problem(n, m, seed=n + m)
    after, error = corrected(P, H, residual, noise, 1e9)
    information = np.linalg.inv(P) + H.T @ np.linalg.solve(noise, H)
    np.testing.assert_allclose(after, np.linalg.inv(information), atol=1e-10)
    np.testing.assert_allclose(
        error, np.linalg.solve(information, H.T @ np.linalg.solve(noise, residual)), atol=1e-10
    )


def test_the_gate_is_the_squared_mahalanobis_distance() -> None:
    P, H, residual, noise = problem(15, 3, seed=1)
    distance2 = residual @ np.linalg.solve(H @ P @ H.T + noise, residual)
    assert corrected(P, H, residual, noise, 1.001 * distance2) is not None
    assert corrected(P, H, residual, noise, 0.999 * distance2) is None


def test_a_very_sharp_measurement_leaves_the_covariance_positive_definite() -> None:
    P, H, residual, _ = problem(21, 6, seed=2)
    after, _ = corrected(P, H, residual, 1e-12 * np.eye(6), 1e18)
    assert np.linalg.eigvalsh(after)[0] > 0


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_values_that_are_nan_are_refused(wrong) -> None:
    P, H, residual, noise = problem(15, 3, seed=3)
    residual[1] = wrong
    assert corrected(P, H, residual, noise, 1e9) is None
    noise[0, 0] = -1e3
    assert corrected(P, H, np.zeros(3), noise, 1e9) is None


def test_read_only_arrays_are_accepted_and_unchanged() -> None:
    P, H, residual, noise = problem(15, 3, seed=4)
    copies = [a.copy() for a in (P, H, residual, noise)]
    for a in (P, H, residual, noise):
        a.flags.writeable = False
    corrected(P, H, residual, noise, 1e9)
    for a, copy in zip((P, H, residual, noise), copies, strict=True):
        np.testing.assert_array_equal(a, copy)
