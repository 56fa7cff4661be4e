"""What one linear correction leaves out of a fix when the attitude is not known well.

Source: the second-order filter (Jazwinski 1970, Sec. 9.3; Gelb 1974, Sec. 6.1): the second moment
of the terms that a linear correction neglects counts as noise of the measurement.
"""

import numpy as np
from executive_plugins.estimation.kalman.layout import matrix
from numba import njit

from executive.arrays import Float

_COUNTS = 1e-4  # share of the noise's variance below which the neglected terms are not reckoned


@njit(cache=True)  # type: ignore[untyped-decorator]
def add_bend(s: np.record, joint: Float) -> None:
    """Add to the noise of a fix that was compared what a turn of its error leaves out.

    If u is the difference to the fix to first order and θ the error of the attitude, the difference
    is u + θ × u / 2 and smaller terms (see `exponential`). After seconds without fixes, metres
    times degrees are more than the noise of a fix: a linear correction would take them for a
    measurement of the attitude.

    Args:
        s: The filter, with `H`, `predicted` and `noise` of the fix.
        joint: Covariance of the errors of state and companions, shape (15 + k, 15 + k).
    """
    U, noise = matrix(s.predicted, 3, 3), matrix(s.noise, 3, 3)
    turn2, apart2 = s.P[0, 0] + s.P[1, 1] + s.P[2, 2], U[0, 0] + U[1, 1] + U[2, 2]
    least = min(noise[0, 0], noise[1, 1], noise[2, 2])
    if turn2 * apart2 < 4.0 * _COUNTS * least:
        return
    n = len(joint)
    H, A, C = matrix(s.H, 3, n), np.zeros((3, 3)), np.zeros((3, 3))
    for i in range(3):
        for k in range(3):
            for j in range(n):
                total = s.R[i, 0] * joint[0, j] + s.R[i, 1] * joint[1, j] + s.R[i, 2] * joint[2, j]
                C[i, k] += total * H[k, j]
                if j < 3:
                    A[i, k] += total * s.R[k, j]
    for i in range(3):
        for j in range(i + 1):
            bent = 0.25 * _moment(A, U, C, i, j)
            noise[i, j] += bent
            if i != j:
                noise[j, i] += bent


@njit(cache=True)  # type: ignore[untyped-decorator]
def _moment(A: Float, U: Float, C: Float, i: int, j: int) -> float:
    """Return E[(θ × u)ᵢ (θ × u)ⱼ] of normal vectors (Isserlis 1918).

    Args:
        A: Covariance of θ, shape (3, 3).
        U: That of u, shape (3, 3).
        C: Covariance of θ with u, shape (3, 3).
        i, j: Axes.
    """
    k, m, p, q = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    total = 0.0
    for a, b, first in ((k, m, 1.0), (m, k, -1.0)):
        for c, d, second in ((p, q, 1.0), (q, p, -1.0)):
            expected = A[a, c] * U[b, d] + C[a, b] * C[c, d] + C[a, d] * C[c, b]
            total += first * second * expected
    return total
