"""Local frames on the surface of a stone, and the gripper orientations derived from them."""

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.rotation import about_axis

_UP = np.array([0.0, 0.0, 1.0])
_X, _Y, _Z = np.eye(3)


def local_frames(points: Float, normals: Float, at: Float, radius_m: float) -> Float:
    """Return a frame per sample: x out of the stone, z along the least curvature, (n, 3, 3).

    The axes are eigenvectors of M(p) = Σ n nᵀ over the ball around p (Mascaro 2020, Eq. 4). The
    text of the paper assigns x to the smallest eigenvalue, but M is close to n nᵀ, so the
    eigenvector along the normal belongs to the **largest** one. Here x is that eigenvector, with
    the sign of the mean outward normal, and z is the eigenvector of the smallest eigenvalue, the
    direction in which the normals have the least component (on a cylinder, its axis).

    Args:
        points: Surface of the stone [m], shape (N, 3).
        normals: Unit outward normals of the points, shape (N, 3).
        at: Samples on the surface [m], shape (n, 3).
        radius_m: Radius of the ball [m].
    """
    frames = np.empty((len(at), 3, 3))
    for i, ball in enumerate(cKDTree(points).query_ball_point(at, radius_m)):
        n = normals[ball]
        _, vectors = np.linalg.eigh(n.T @ n)
        x, z = vectors[:, 2], vectors[:, 0]
        x = x if x @ n.sum(axis=0) >= 0 else -x
        z = z if z[np.argmax(np.abs(z))] >= 0 else -z
        frames[i] = np.column_stack([x, np.cross(z, x), z])
    return frames


def turned_frames(frames: Float, about_y_rad: Float, about_z_rad: Float) -> Float:
    """Return gripper orientations: each frame turned about its y and z axes, (n·a·b, 3, 3).

    All combinations of the angles are returned. The approach axis x of the gripper points into the
    stone, so it is −x of the turned frame; y is kept, and z is reversed.
    """
    turns = np.array(
        [about_axis(_Z, z) @ about_axis(_Y, y) for z in about_z_rad for y in about_y_rad]
    )
    return (frames[:, None] @ (turns * (-1.0, 1.0, -1.0))).reshape(-1, 3, 3)


def downward_frames(yaw_rad: Float) -> Float:
    """Return orientations that approach straight down at given yaws [rad], shape (n, 3, 3)."""
    y = np.column_stack([np.cos(yaw_rad), np.sin(yaw_rad), np.zeros(len(yaw_rad))])
    x = np.broadcast_to(-_UP, y.shape)
    return np.stack([x, y, np.cross(x, y)], axis=-1)
