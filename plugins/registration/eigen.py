"""Eigenvectors of symmetric 3×3 matrices by Jacobi rotations.

Other than a linear algebra library, it gives the same bits on every processor.
"""

import numpy as np
from numba import njit

from executive.arrays import Float

Eight = tuple[float, float, float, float, float, float, float, float]
Axis = tuple[float, float, float]
_SWEEPS = 8  # convergence is quadratic: five sweeps reach double precision


@njit(cache=True)  # type: ignore[untyped-decorator]
def sorted_eigenvectors(matrix: Float) -> tuple[Float, Float]:
    """Return the eigenvalues (3,), largest first, and their eigenvectors as rows (3, 3).

    Elements have names of their own, aa to cc, so that they stay in the processor's registers.
    """
    aa, ab, ac = matrix[0, 0], matrix[0, 1], matrix[0, 2]
    ba, bb, bc = matrix[1, 0], matrix[1, 1], matrix[1, 2]
    ca, cb, cc = matrix[2, 0], matrix[2, 1], matrix[2, 2]
    a, b, c = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    for _ in range(_SWEEPS):
        if ab**2 + ac**2 + bc**2 <= 1e-30 * (aa + bb + cc) ** 2:
            break
        turn = _turn(aa, ab, bb)
        aa, ab, ac, ba, bb, bc, ca, cb = _turned(turn, (aa, ab, ac, ba, bb, bc, ca, cb))
        a, b = _turned_axes(turn, a, b)
        turn = _turn(aa, ac, cc)
        aa, ac, ab, ca, cc, cb, ba, bc = _turned(turn, (aa, ac, ab, ca, cc, cb, ba, bc))
        a, c = _turned_axes(turn, a, c)
        turn = _turn(bb, bc, cc)
        bb, bc, ba, cb, cc, ca, ab, ac = _turned(turn, (bb, bc, ba, cb, cc, ca, ab, ac))
        b, c = _turned_axes(turn, b, c)
    if aa < bb:
        aa, bb, a, b = bb, aa, b, a
    if bb < cc:
        bb, cc, b, c = cc, bb, c, b
    if aa < bb:
        aa, bb, a, b = bb, aa, b, a
    values, axes = np.empty(3), np.empty((3, 3))
    values[0], values[1], values[2] = aa, bb, cc
    for k in range(3):
        axes[0, k], axes[1, k], axes[2, k] = a[k], b[k], c[k]
    return values, axes


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turn(pp: float, pq: float, qq: float) -> tuple[float, float]:
    """Return cosine and sine of the rotation of axes p and q by which the element pq becomes 0
    (Golub and Van Loan, Sec. 8.5).
    """
    if pq == 0.0:
        return 1.0, 0.0
    theta = (qq - pp) / (2 * pq)
    t = (1.0 if theta >= 0 else -1.0) / (abs(theta) + np.sqrt(theta * theta + 1))
    c = 1 / np.sqrt(t * t + 1)
    return c, t * c


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turned(turn: tuple[float, float], elements: Eight) -> Eight:
    """Return the elements pp, pq, pr, qp, qq, qr, rp and rq after a rotation of axes p and q."""
    c, s = turn
    pp, pq, pr, qp, qq, qr, rp, rq = elements
    pp, pq = c * pp - s * pq, s * pp + c * pq
    qp, qq = c * qp - s * qq, s * qp + c * qq
    rp, rq = c * rp - s * rq, s * rp + c * rq
    pp, qp = c * pp - s * qp, s * pp + c * qp
    pq, qq = c * pq - s * qq, s * pq + c * qq
    pr, qr = c * pr - s * qr, s * pr + c * qr
    return pp, pq, pr, qp, qq, qr, rp, rq


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turned_axes(turn: tuple[float, float], p: Axis, q: Axis) -> tuple[Axis, Axis]:
    c, s = turn
    return (
        (c * p[0] - s * q[0], c * p[1] - s * q[1], c * p[2] - s * q[2]),
        (s * p[0] + c * q[0], s * p[1] + c * q[1], s * p[2] + c * q[2]),
    )
