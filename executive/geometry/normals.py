"""Normals of a surface that is given by points."""

import numpy as np

from executive.arrays import Float


def outward_normals(points: Float, inside: Float, neighbours: int = 16) -> Float:
    """Return unit surface normals that point away from a point inside the stone, shape (N, 3).

    Args:
        points: Surface of the stone [m], shape (N, 3).
        inside: A point within the stone [m], shape (3,). On a convex stone every sign is then
            correct.
        neighbours: Number of nearest points that span the tangent plane.
    """
    from scipy.spatial import cKDTree  # reading a mission imports no algorithm

    _, index = cKDTree(points).query(points, k=min(neighbours, len(points)))
    patch = points[index] - points[index].mean(axis=1, keepdims=True)
    _, vectors = np.linalg.eigh(patch.transpose(0, 2, 1) @ patch)
    normals = vectors[:, :, 0]  # the eigenvector of the smallest eigenvalue is normal to the patch
    sign = np.where(np.einsum("ij,ij->i", normals, points - inside) < 0, -1.0, 1.0)
    return np.asarray(normals * sign[:, None])
