"""Rotations in SO(3) as 3×3 matrices; unit quaternions are ordered w, x, y, z."""

import math

import numpy as np

from executive.arrays import Float


def skew(v: Float) -> Float:
    """Return the matrix [v]× with [v]× u = v × u, shape (3, 3)."""
    x, y, z = np.asarray(v, dtype=float).tolist()
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


# The functions below are called for every inertial sample and every slice of a scan. On three
# numbers, Python's floats take a sixth of the time of numpy's arrays.


def exp_so3(rotation_vector: Float) -> Float:
    """Map a rotation vector [rad] to its matrix (Rodrigues), shape (3,) → (3, 3)."""
    x, y, z = np.asarray(rotation_vector, dtype=float).tolist()
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    if angle < 1e-8:  # second order of the series; the next term is below 1e-24
        a, b = 1.0, 0.5
    else:
        a, b = math.sin(angle) / angle, (1.0 - math.cos(angle)) / square
    return np.array(
        (
            (1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y),
            (b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x),
            (b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)),
        )
    )


def log_so3(R: Float) -> Float:
    """Map a rotation matrix to its rotation vector [rad] of length 0 to π, (3, 3) → (3,)."""
    w, x, y, z = _quaternion(R)
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 if sine < 1e-12 else 2.0 * math.atan2(sine, w) / sine
    return np.array((scale * x, scale * y, scale * z))


def quaternion_wxyz(R: Float) -> Float:
    """Return the unit quaternion with w ≥ 0 of a rotation matrix, (3, 3) → (4,).

    Source: Shepperd 1978.
    """
    return np.array(_quaternion(R))


def _quaternion(R: Float) -> tuple[float, float, float, float]:
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = R.tolist()
    trace = xx + yy + zz
    largest = max(trace, xx, yy, zz)
    if largest == trace:
        w, x, y, z = 1 + trace, zy - yz, xz - zx, yx - xy
    elif largest == xx:
        w, x, y, z = zy - yz, 1 + xx - yy - zz, yx + xy, zx + xz
    elif largest == yy:
        w, x, y, z = xz - zx, xy + yx, 1 + yy - zz - xx, zy + yz
    else:
        w, x, y, z = yx - xy, xz + zx, yz + zy, 1 + zz - xx - yy
    length = math.sqrt(w * w + x * x + y * y + z * z)
    length = -length if w < 0 else length
    return w / length, x / length, y / length, z / length


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


def angle_of_jaws(R_a: Float, R_b: Float) -> float:
    """Return the angle [rad] between two orientations of a gripper with two jaws, in [0, π].

    Half a turn about the approach, the x axis, is none, since it only exchanges the jaws.
    """
    D = R_a.T @ R_b
    half_turned = D[0, 0] - D[1, 1] - D[2, 2]
    return float(np.arccos(np.clip((max(np.trace(D), half_turned) - 1) / 2, -1.0, 1.0)))


def yaw_of(R: Float) -> float:
    """Return the heading [rad]: the angle of the rotated x axis about z, from the x axis."""
    return float(np.arctan2(R[1, 0], R[0, 0]))


def wrap_angle(angle_rad: float) -> float:
    """Return the same angle in (−π, π]."""
    return float(-((np.pi - angle_rad) % (2 * np.pi) - np.pi))
