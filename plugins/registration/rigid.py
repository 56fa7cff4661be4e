"""The rigid motion, with or without a scale, that lays points over their partners."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose


def rigid_between(target: Float, source: Float) -> Float:
    """Return T_target_source of least squares (Umeyama 1991), both (N, 3) with N ≥ 3."""
    mean_t, mean_s = target.mean(axis=0), source.mean(axis=0)
    U, _, Vt = np.linalg.svd((target - mean_t).T @ (source - mean_s))
    R = U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    return pose(R, mean_t - R @ mean_s)
