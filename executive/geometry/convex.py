"""Convex hulls of points: their half-spaces, volume and corners."""

from typing import TYPE_CHECKING

import numpy as np

from executive.arrays import Float
from executive.errors import DataError

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull


def half_spaces(vertices: Float) -> Float:
    """Return the faces of the convex hull of points (V, 3), shape (F, 4).

    A face (n, d) has a unit normal n that points outwards: n·p ≤ d for every point p inside.

    Raises:
        DataError: If the points span no volume.
    """
    return _faces(_hull(vertices))


def depth_inside(faces: Float, points: Float) -> Float:
    """Return how deep each point (N, 3) is in a polyhedron [m]; negative outside, shape (N,)."""
    return np.asarray((faces[:, 3] - points @ faces[:, :3].T).min(axis=1))


def volume_and_centroid(vertices: Float) -> tuple[float, Float]:
    """Return the volume [m³] and the centre of volume (3,) of the convex hull of points (V, 3).

    Raises:
        DataError: If the points span no volume.
    """
    hull = _hull(vertices)
    middle = vertices[hull.vertices].mean(axis=0)
    corners = vertices[hull.simplices] - middle  # a tetrahedron between each face and the middle
    volumes = np.abs(np.linalg.det(corners)) / 6
    centres = corners.sum(axis=1) / 4
    return float(volumes.sum()), np.asarray(middle + volumes @ centres / volumes.sum())


def convex_corners(points: Float) -> Float:
    """Return the points that are corners of the convex hull of all, (N, 3) → (V, 3).

    Raises:
        DataError: If the points span no volume.
    """
    return np.asarray(points[_hull(points).vertices])


def _hull(vertices: Float) -> "ConvexHull":
    from scipy.spatial import ConvexHull, QhullError  # slow to import: reading a mission needs none

    try:
        return ConvexHull(vertices)
    except (QhullError, ValueError) as error:
        raise DataError(
            f"{len(vertices)} points span no volume; a convex hull needs four that are not flat"
        ) from error


def _faces(hull: "ConvexHull") -> Float:
    faces = hull.equations * (1.0, 1.0, 1.0, -1.0)
    return np.asarray(np.unique(faces.round(12), axis=0))  # one plane for all triangles of a face
