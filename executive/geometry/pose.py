"""Poses in SE(3) as 4×4 matrices `T_<to>_<from>`: `p_to = T_to_from @ p_from`."""

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, from_rpy, log_so3, skew


def pose(R: Float | None = None, t: Float | None = None) -> Float:
    """Assemble a pose from a rotation (3, 3) and a translation (3,) [m]; each defaults to none."""
    T = np.eye(4)
    if R is not None:
        T[:3, :3] = R
    if t is not None:
        T[:3, 3] = t
    return T


def pose_xyz_rpy(xyz: Float, rpy: Float) -> Float:
    """Assemble a pose from an origin as in URDF: position [m] and roll, pitch, yaw [rad]."""
    return pose(from_rpy(*np.asarray(rpy, dtype=float)), np.asarray(xyz, dtype=float))


def inverse(T: Float) -> Float:
    """Return T_b_a for T_a_b, using the transpose of its rotation."""
    R = T[:3, :3].T
    return pose(R, -R @ T[:3, 3])


def transform(T_to_from: Float, points_from: Float) -> Float:
    """Express points (N, 3) or one point (3,) in the other frame."""
    return np.asarray(points_from @ T_to_from[:3, :3].T + T_to_from[:3, 3])


def adjoint(T_to_from: Float) -> Float:
    """Return the adjoint of a pose, which expresses a twist in the other frame, shape (6, 6).

    A twist, or a small error, is ordered as rotation [rad], then translation [m], both in body
    axes: T exp(x) T⁻¹ = exp(adjoint(T) x). A covariance follows as adjoint(T) P adjoint(T)ᵀ.
    """
    R = T_to_from[:3, :3]
    J = np.zeros((6, 6))
    J[:3, :3] = J[3:, 3:] = R
    J[3:, :3] = skew(T_to_from[:3, 3]) @ R
    return J


def interpolate(T_a: Float, T_b: Float, fraction: float) -> Float:
    """Return the pose at a fraction between two: a geodesic in rotation, a line in translation."""
    R = T_a[:3, :3] @ exp_so3(fraction * log_so3(T_a[:3, :3].T @ T_b[:3, :3]))
    return pose(R, (1 - fraction) * T_a[:3, 3] + fraction * T_b[:3, 3])
