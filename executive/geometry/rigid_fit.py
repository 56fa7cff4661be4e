"""Motions of least squares between points and their partners."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose


def rigid_fit(target: Float, source: Float) -> Float:
    """Return T_target_source of the rigid motion that best lays points over their partners.

    Args:
        target: Points [m], shape (N, 3), N ≥ 3, not all in a line.
        source: Their partners, in the same order [m], shape (N, 3).

    Source: Umeyama 1991, with the scale held at 1.
    """
    mean_t, mean_s = target.mean(axis=0), source.mean(axis=0)
    R = _rotation(target - mean_t, source - mean_s)[0]
    return pose(R, mean_t - R @ mean_s)


def similarity_fit(target: Float, source: Float) -> tuple[float, Float, Float]:
    """Return scale, R and t of the similarity target = scale · R source + t of least squares.

    Args:
        target: Points [m], shape (N, 3), N ≥ 3, not all in a line.
        source: Their partners, in the same order, shape (N, 3).

    Source: Umeyama 1991, Eq. (40) to (43).
    """
    mean_t, mean_s = target.mean(axis=0), source.mean(axis=0)
    R, trace = _rotation(target - mean_t, source - mean_s)
    scale = trace / max(float(((source - mean_s) ** 2).sum()), 1e-300)
    return scale, R, mean_t - scale * R @ mean_s


def _rotation(target: Float, source: Float) -> tuple[Float, float]:
    """Return the best rotation between centred points, and the trace of D S in Eq. (42)."""
    U, S, Vt = np.linalg.svd(target.T @ source)
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))])  # excludes a reflection
    return (U * signs) @ Vt, float((S * signs).sum())
