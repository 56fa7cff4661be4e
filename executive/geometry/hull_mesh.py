"""The surface of a convex hull as triangles that face outwards."""

from typing import TYPE_CHECKING

import numpy as np

from executive.arrays import Float, Int

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull


def hull_mesh(points: Float) -> tuple[Float, Int]:
    """Return the corners (V, 3) and triangles (F, 3) of the convex hull of points (N, 3).

    The triangles index the corners, counter-clockwise from outside.

    Raises:
        scipy.spatial.QhullError: If the points span no volume.
    """
    from scipy.spatial import ConvexHull  # slow to import: reading a mission needs none

    return mesh_of(ConvexHull(points))


def mesh_of(hull: "ConvexHull") -> tuple[Float, Int]:
    """Return the same of a hull that has been computed already."""
    new_index = np.full(len(hull.points), -1)
    new_index[hull.vertices] = np.arange(len(hull.vertices))
    corners, triangles = hull.points[hull.vertices], new_index[hull.simplices]
    a, b, c = (corners[triangles[:, i]] for i in range(3))
    is_inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[is_inward] = triangles[is_inward][:, ::-1]
    return np.asarray(corners), np.asarray(triangles)
