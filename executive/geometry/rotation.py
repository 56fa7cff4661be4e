"""Rotations in SO(3) as 3×3 matrices; unit quaternions are ordered w, x, y, z."""

import numpy as np

from executive.arrays import Float


def skew(v: Float) -> Float:
    """Return the matrix [v]× with [v]× u = v × u, shape (3, 3)."""
    x, y, z = np.asarray(v, dtype=float).tolist()
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


def exp_so3(rotation_vector: Float) -> Float:
    """Map a rotation vector [rad] to its matrix (Rodrigues), shape (3,) → (3, 3)."""
    angle = float(np.linalg.norm(rotation_vector))
    K = skew(rotation_vector)
    if angle < 1e-8:  # second order of the series; the next term is below 1e-24
        return np.asarray(np.eye(3) + K + 0.5 * K @ K)
    return np.asarray(
        np.eye(3) + np.sin(angle) / angle * K + (1 - np.cos(angle)) / angle**2 * K @ K
    )


def log_so3(R: Float) -> Float:
    """Map a rotation matrix to its rotation vector [rad] of length 0 to π, (3, 3) → (3,)."""
    w, *v = quaternion_wxyz(R)
    axis = np.array(v)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return np.asarray(2.0 * axis)
    return np.asarray(axis * (2.0 * np.arctan2(sine, w) / sine))


def quaternion_wxyz(R: Float) -> Float:
    """Return the unit quaternion with w ≥ 0 of a rotation matrix, (3, 3) → (4,).

    Source: Shepperd 1978.
    """
    m = np.array([np.trace(R), R[0, 0], R[1, 1], R[2, 2]])
    i = int(np.argmax(m))
    if i == 0:
        q = np.array([1 + m[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        a, b, c = i - 1, i % 3, (i + 1) % 3
        q = np.zeros(4)
        q[0] = R[c, b] - R[b, c]
        q[1 + a] = 1 + R[a, a] - R[b, b] - R[c, c]
        q[1 + b] = R[b, a] + R[a, b]
        q[1 + c] = R[c, a] + R[a, c]
    q /= np.linalg.norm(q)
    return np.asarray(-q if q[0] < 0 else q)


def from_quaternion(q_wxyz: Float) -> Float:
    """Return the rotation matrix of a quaternion (normalised first), shape (4,) → (3, 3)."""
    w, x, y, z = np.asarray(q_wxyz, dtype=float) / np.linalg.norm(q_wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def from_rpy(roll: float, pitch: float, yaw: float) -> Float:
    """Return Rz(yaw) Ry(pitch) Rx(roll), the fixed-axis convention of URDF and REP-103 [rad]."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def about_axis(axis: Float, angle_rad: float) -> Float:
    """Return the rotation by an angle [rad] about a unit axis, shape (3, 3)."""
    return exp_so3(np.asarray(axis, dtype=float) * angle_rad)


def angle_between(R_a: Float, R_b: Float) -> float:
    """Return the angle [rad] of the rotation between two orientations, in [0, π]."""
    return float(np.linalg.norm(log_so3(R_a.T @ R_b)))


def yaw_of(R: Float) -> float:
    """Return the heading [rad]: the angle of the rotated x axis about z, from the x axis."""
    return float(np.arctan2(R[1, 0], R[0, 0]))


def wrap_angle(angle_rad: float) -> float:
    """Return the same angle in (−π, π]."""
    return float(-((np.pi - angle_rad) % (2 * np.pi) - np.pi))
