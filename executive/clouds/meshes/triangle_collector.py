"""Triangles collected from the faces of a file, each index checked."""

from array import array
from collections.abc import Sequence

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.meshes.damage import MeshDamageError


class TriangleCollector:
    """Splits polygons into fans of triangles; keeps the indices of their corners, from 0."""

    def __init__(self) -> None:
        self._corners = array("q")

    def add(self, polygon: Sequence[int]) -> None:
        """Add a face by the indices of its corners.

        Raises:
            MeshDamageError: If it has fewer than three, or one is beyond any file.
        """
        if len(polygon) < 3:
            raise MeshDamageError(f"a face has {len(polygon)} corners, and 3 are the least")
        try:
            for i in range(1, len(polygon) - 1):
                self._corners.extend((polygon[0], polygon[i], polygon[i + 1]))
        except OverflowError:
            raise MeshDamageError(f"a face has a corner {max(polygon, key=abs)}") from None

    def triangles(self) -> Int:
        """Return the indices, shape (N, 3)."""
        return np.array(self._corners, dtype=np.int64).reshape(-1, 3)


def fans(polygons: np.ndarray) -> Int:
    """Return the triangles of polygons with the same number of corners each, shape (N, K)."""
    corners = polygons.shape[1]
    split = [polygons[:, (0, i, i + 1)] for i in range(1, corners - 1)]
    return np.stack(split, axis=1).reshape(-1, 3).astype(np.int64)


def check_corners(triangles: Int, vertices: Float) -> None:
    """Check that each index names a vertex.

    Raises:
        MeshDamageError: If one does not.
    """
    if not len(triangles):
        return
    for index in (int(triangles.min()), int(triangles.max())):
        if not 0 <= index < len(vertices):
            raise MeshDamageError(f"a face has the corner {index} of {len(vertices)} vertices")
