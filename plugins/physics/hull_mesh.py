"""The surface of a convex hull as triangles that look outwards."""

import numpy as np
from scipy.spatial import ConvexHull

from executive.arrays import Float, Int


def hull_mesh(points: Float) -> tuple[Float, Int]:
    """Return the hull's corners (V, 3) and its triangles (F, 3), counter-clockwise from outside.

    Raises:
        scipy.spatial.QhullError: If the points span no volume.
    """
    hull = ConvexHull(points)
    new_index = np.full(len(points), -1)
    new_index[hull.vertices] = np.arange(len(hull.vertices))
    corners, triangles = np.asarray(points)[hull.vertices], new_index[hull.simplices]
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return corners, triangles
