"""The correction of a Kalman filter in compiled form.

Several corrections may be due at one inertial sample, and the cost of NumPy calls would delay it.
"""

import math

import numpy as np
from executive_plugins.estimation.cholesky import forward, triangulate
from numba import njit, types

from executive.arrays import Float

_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_MATRIX = types.float64[:, ::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _innovate(H: Float, P: Float, residual: Float, noise: Float, right: Float, S: Float) -> None:
    """Write (H P | residual), shape (m, n + 1), and H P Hᵀ + noise, shape (m, m)."""
    m, n = H.shape
    for i in range(m):
        for j in range(n):
            right[i, j] = 0.0
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


@njit(cache=True)  # type: ignore[untyped-decorator]
def correct_into(  # noqa: PLR0913 - compiled code takes the arrays of a problem one by one
    P: Float,
    H: Float,
    residual: Float,
    noise: Float,
    gate: float,
    W: Float,
    L: Float,
    after: Float,
    error: Float,
) -> float:
    """Correct by measured − predicted = H · error + noise.

    With H P Hᵀ + noise = L Lᵀ and W = L⁻¹ H P, the results are P − Wᵀ W and Wᵀ L⁻¹ residual. The
    covariance is exactly symmetric, and positive definite as long as the noise is above rounding.

    Args:
        P: Covariance of the error before, shape (n, n).
        H: Shape (m, n).
        residual: Shape (m,).
        noise: Covariance of the measurement, shape (m, m).
        gate: Largest squared Mahalanobis distance that is accepted.
        W: Result, (W | L⁻¹ residual), shape (m, n + 1).
        L: Result, in its lower triangle, shape (m, m).
        after: Result, the covariance after, shape (n, n).
        error: Result, the error, shape (n,).

    Returns:
        The squared Mahalanobis distance; inf if there is none. Covariance and error are written if
        it is within the gate.
    """
    n, m = P.shape[0], H.shape[0]
    _innovate(H, P, residual, noise, W, L)
    if not triangulate(L):
        return math.inf
    forward(L, W)
    distance2 = 0.0
    for i in range(m):
        distance2 += W[i, n] * W[i, n]
    if not distance2 <= gate:
        return math.inf if math.isnan(distance2) else distance2
    for j in range(n):
        error[j] = 0.0
        for i in range(m):
            error[j] += W[i, j] * W[i, n]
    for i in range(n):
        for j in range(i + 1):
            value = 0.5 * (P[i, j] + P[j, i])
            for k in range(m):
                value -= W[k, i] * W[k, j]
            after[i, j] = after[j, i] = value
    return distance2


@njit(cache=True)  # type: ignore[untyped-decorator]
def consider_into(  # noqa: PLR0913 - compiled code takes the arrays of a problem one by one
    P: Float,
    H: Float,
    residual: Float,
    noise: Float,
    held: int,
    W: Float,
    L: Float,
    after: Float,
    error: Float,
) -> None:
    """Correct all but one quantity, which is left as it is.

    Its uncertainty counts in the correction of the others (Schmidt 1966).

    Args:
        held: Index of the quantity.
        W, L: As `correct_into` has left them.

    The others are those of `correct_into`.
    """
    n, m = P.shape[0], H.shape[0]
    K = np.empty((n, m))
    for c in range(n):
        for i in range(m - 1, -1, -1):
            rest = W[i, c]
            for j in range(i + 1, m):
                rest -= L[j, i] * K[c, j]
            K[c, i] = rest / L[i, i]
    K[held, :] = 0.0
    J, scatter = np.eye(n), np.empty((n, n))
    for i in range(n):
        error[i] = 0.0
        for k in range(m):
            error[i] += K[i, k] * residual[k]
            for j in range(n):
                J[i, j] -= K[i, k] * H[k, j]
    project_into(J, P, after)
    project_into(K, noise, scatter)
    # Rounding that leaves the two triangles apart grows from one correction to the next.
    for i in range(n):
        for j in range(i + 1):
            value = 0.5 * (after[i, j] + after[j, i]) + scatter[i, j]
            after[i, j] = after[j, i] = value


@njit(cache=True)  # type: ignore[untyped-decorator]
def project_into(H: Float, P: Float, after: Float) -> None:
    """Write H P Hᵀ, the covariance of a prediction, shapes (m, n), (n, n) → (m, m)."""
    m, n = H.shape
    row, counts, places = np.empty(n), np.zeros(m, np.int64), np.empty((m, n), np.int64)
    for i in range(m):
        for k in range(n):
            if H[i, k] != 0.0:  # most entries are zero
                places[i, counts[i]] = k
                counts[i] += 1
    for i in range(m):
        row[:] = 0.0
        for q in range(counts[i]):
            k = places[i, q]
            for j in range(n):
                row[j] += H[i, k] * P[k, j]
        for j in range(m):
            total = 0.0
            for q in range(counts[j]):
                total += row[places[j, q]] * H[j, places[j, q]]
            after[i, j] = total


@njit(types.void(_MATRIX, _MATRIX, _NEW_MATRIX), cache=True)  # type: ignore[untyped-decorator]
def _project(H: Float, P: Float, after: Float) -> None:
    """Do what `project_into` does, for callers that are not compiled."""
    project_into(H, P, after)


def projected(H: Float, P: Float) -> Float:
    """Return H P Hᵀ, the covariance of a prediction, shapes (m, n), (n, n) → (m, m)."""
    after = np.empty((len(H), len(H)))
    _project(H, P, after)
    return after
