"""The correction of a Kalman filter in compiled form.

Several corrections may be due at one inertial sample, and the cost of NumPy calls would delay it.
"""

import numpy as np
from executive_plugins.estimation.cholesky import forward, triangulate
from numba import njit, types

from executive.arrays import Float

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_VECTOR, _NEW_MATRIX = types.float64[::1], types.float64[:, ::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _innovation(H: Float, P: Float, residual: Float, noise: Float) -> tuple[Float, Float]:
    """Return (H P | residual), shape (m, n + 1), and H P Hᵀ + noise, shape (m, m)."""
    m, n = H.shape
    right, S = np.zeros((m, n + 1)), np.empty((m, m))
    for i in range(m):
        for k in range(n):
            if H[i, k] != 0.0:  # most entries are zero
                for j in range(n):
                    right[i, j] += H[i, k] * P[k, j]
        right[i, n] = residual[i]
    for i in range(m):
        for j in range(m):
            S[i, j] = noise[i, j]
            for k in range(n):
                S[i, j] += right[i, k] * H[j, k]
    return right, S


@njit(  # type: ignore[untyped-decorator]
    types.boolean(_MATRIX, _MATRIX, _VECTOR, _MATRIX, types.float64, _NEW_MATRIX, _NEW_VECTOR),
    cache=True,
)
def _correct(
    P: Float, H: Float, residual: Float, noise: Float, gate: float, after: Float, error: Float
) -> bool:
    """Do what `corrected` does, with results in arrays of the caller."""
    n = P.shape[0]
    W, L = _innovation(H, P, residual, noise)
    if not triangulate(L):
        return False
    forward(L, W)
    distance2 = 0.0
    error[:] = 0.0
    for i in range(L.shape[0]):
        distance2 += W[i, n] * W[i, n]
        for j in range(n):
            error[j] += W[i, j] * W[i, n]
    if not distance2 <= gate:
        return False
    for i in range(n):
        for j in range(i + 1):
            value = 0.5 * (P[i, j] + P[j, i])
            for k in range(L.shape[0]):
                value -= W[k, i] * W[k, j]
            after[i, j] = after[j, i] = value
    return True


@njit(types.void(_MATRIX, _MATRIX, _NEW_MATRIX), cache=True)  # type: ignore[untyped-decorator]
def _project(H: Float, P: Float, after: Float) -> None:
    """Do what `projected` does, with the result in an array of the caller."""
    n = P.shape[0]
    row = np.empty(n)
    for i in range(H.shape[0]):
        row[:] = 0.0
        for k in range(n):
            if H[i, k] != 0.0:  # most entries are zero
                for j in range(n):
                    row[j] += H[i, k] * P[k, j]
        for j in range(H.shape[0]):
            after[i, j] = 0.0
            for k in range(n):
                after[i, j] += row[k] * H[j, k]


def projected(H: Float, P: Float) -> Float:
    """Return H P Hᵀ, the covariance of a prediction, shapes (m, n), (n, n) → (m, m)."""
    after = np.empty((len(H), len(H)))
    _project(H, P, after)
    return after


def corrected(
    P: Float, H: Float, residual: Float, noise: Float, gate: float
) -> tuple[Float, Float] | None:
    """Correct by measured − predicted = H · error + noise.

    With H P Hᵀ + noise = L Lᵀ and W = L⁻¹ H P, the results are P − Wᵀ W and Wᵀ L⁻¹ residual. The
    covariance is exactly symmetric, and positive definite as long as the noise is above rounding.

    Args:
        P: Covariance of the error before, shape (n, n).
        H: Shape (m, n).
        residual: Shape (m,).
        noise: Covariance of the measurement, shape (m, m).
        gate: Largest squared Mahalanobis distance that is accepted.

    Returns:
        The covariance after, shape (n, n), and the error, shape (n,); None if the measurement is
        beyond the gate.
    """
    after, error = np.empty(P.shape), np.empty(len(P))
    return (after, error) if _correct(P, H, residual, noise, gate, after, error) else None


def considered(P: Float, H: Float, residual: Float, noise: Float, held: int) -> tuple[Float, Float]:
    """Return covariance and error after a correction that leaves one quantity as it is.

    Its uncertainty counts in the correction of the others (Schmidt 1966).

    Args:
        P: Covariance before, shape (n, n).
        H: Derivative of the measurement by the error, shape (m, n).
        residual: Measured minus predicted, shape (m,).
        noise: Covariance of the measurement, shape (m, m).
        held: Index of the quantity.
    """
    K = np.linalg.solve(H @ P @ H.T + noise, H @ P).T
    K[held] = 0.0
    J = np.eye(len(P)) - K @ H
    return J @ P @ J.T + K @ noise @ K.T, K @ residual
