"""Eigenvectors of symmetric 3×3 matrices by Jacobi rotations.

Other than a linear algebra library, it gives the same bits on every processor.
"""

import numpy as np
from numba import njit

from executive.arrays import Float

_SWEEPS = 8  # convergence is quadratic: five sweeps reach double precision


@njit(cache=True)  # type: ignore[untyped-decorator]
def sorted_eigenvectors(matrix: Float) -> tuple[Float, Float]:
    """Return the eigenvalues (3,), largest first, and their eigenvectors as rows (3, 3)."""
    A, V = matrix.copy(), np.eye(3)
    for _ in range(_SWEEPS):
        if A[0, 1] ** 2 + A[0, 2] ** 2 + A[1, 2] ** 2 <= 1e-30 * (A[0, 0] + A[1, 1] + A[2, 2]) ** 2:
            break
        for p in range(2):
            for q in range(p + 1, 3):
                _rotate(A, V, p, q)
    values, vectors = np.array([A[0, 0], A[1, 1], A[2, 2]]), V.T.copy()
    for i, j in ((0, 1), (1, 2), (0, 1)):
        if values[i] < values[j]:
            values[i], values[j] = values[j], values[i]
            for k in range(3):
                vectors[i, k], vectors[j, k] = vectors[j, k], vectors[i, k]
    return values, vectors


@njit(cache=True)  # type: ignore[untyped-decorator]
def _rotate(A: Float, V: Float, p: int, q: int) -> None:
    """Rotate axes p and q, in place, so that A[p, q] becomes 0 (Golub and Van Loan, Sec. 8.5)."""
    if A[p, q] == 0.0:
        return
    theta = (A[q, q] - A[p, p]) / (2 * A[p, q])
    t = (1.0 if theta >= 0 else -1.0) / (abs(theta) + np.sqrt(theta * theta + 1))
    c = 1 / np.sqrt(t * t + 1)
    s = t * c
    for k in range(3):
        A[k, p], A[k, q] = c * A[k, p] - s * A[k, q], s * A[k, p] + c * A[k, q]
    for k in range(3):
        A[p, k], A[q, k] = c * A[p, k] - s * A[q, k], s * A[p, k] + c * A[q, k]
    for k in range(3):
        V[k, p], V[k, q] = c * V[k, p] - s * V[k, q], s * V[k, p] + c * V[k, q]
