"""Cholesky factors of small covariances in compiled form.

Several measurements may be due at one inertial sample, and NumPy calls on arrays of this size cost
far more than their arithmetic. Signatures are fixed, so that no sample waits for a compiler.
"""

import math

import numpy as np
from numba import njit, types

from executive.arrays import Float

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_VECTOR, _NEW_MATRIX = types.float64[::1], types.float64[:, ::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def triangulate(S: Float) -> bool:
    """Replace the lower triangle of a symmetric matrix (m, m) by its Cholesky factor.

    Returns:
        Whether the matrix is positive definite.
    """
    for i in range(S.shape[0]):
        for j in range(i + 1):
            rest = S[i, j]
            for k in range(j):
                rest -= S[i, k] * S[j, k]
            if i > j:
                S[i, j] = rest / S[j, j]
            elif rest > 0.0:
                S[i, i] = math.sqrt(rest)
            else:  # also for NaN
                return False
    return True


@njit(cache=True)  # type: ignore[untyped-decorator]
def forward(L: Float, b: Float) -> None:
    """Replace b by L⁻¹ b, with the lower triangle of L, shapes (m, m), (m, k)."""
    for i in range(L.shape[0]):
        for c in range(b.shape[1]):
            rest = b[i, c]
            for j in range(i):
                rest -= L[i, j] * b[j, c]
            b[i, c] = rest / L[i, i]


@njit(cache=True)  # type: ignore[untyped-decorator]
def whiten(S: Float, x: Float, L: Float, white: Float) -> float:
    """Write the Cholesky factor of S and L⁻¹ x, shapes (m, m), (m,).

    Returns:
        The squared length of L⁻¹ x; NaN if S is not positive definite.
    """
    m = len(x)
    for i in range(m):
        for j in range(m):
            L[i, j] = S[i, j] if j <= i else 0.0
    if not triangulate(L):
        return math.nan
    distance2 = 0.0
    for i in range(m):
        rest = x[i]
        for j in range(i):
            rest -= L[i, j] * white[j]
        white[i] = rest / L[i, i]
        distance2 += white[i] * white[i]
    return distance2


@njit(types.float64(_MATRIX, _VECTOR, _NEW_MATRIX, _NEW_VECTOR), cache=True)  # type: ignore[untyped-decorator]
def _whiten(S: Float, x: Float, L: Float, white: Float) -> float:
    """Do what `whiten` does, for callers that are not compiled."""
    return float(whiten(S, x, L, white))


def whitened(covariance: Float, innovation: Float) -> tuple[Float, Float, float] | None:
    """Return an innovation in standard deviations, shape (m,); None if that says nothing.

    Args:
        covariance: Of the innovation, shape (m, m).
        innovation: Shape (m,).

    Returns:
        L⁻¹ innovation and L, the Cholesky factor of the covariance, shapes (m,) and (m, m), and the
        squared length of the first; None if the covariance is not positive definite or a value is
        not finite.
    """
    L, white = np.empty(covariance.shape), np.empty(len(innovation))
    distance2 = _whiten(covariance, innovation, L, white)
    return (white, L, distance2) if math.isfinite(distance2) else None


def squared_distance(covariance: Float, innovation: Float) -> float:
    """Return the squared Mahalanobis distance; inf if the covariance is not positive definite."""
    found = whitened(covariance, innovation)
    return float("inf") if found is None else found[2]
