"""Convex solids as triangle meshes."""

from collections.abc import Iterable

import numpy as np
import rerun as rr

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh

Colour = tuple[int, ...]


def mesh(hulls: Iterable[Float], colour: Colour) -> rr.Mesh3D:
    """Return one flat-shaded mesh of several convex hulls, each given by its corners (V, 3)."""
    triangles = np.vstack([corners[faces] for corners, faces in map(hull_mesh, hulls)])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return rr.Mesh3D(
        vertex_positions=triangles.reshape(-1, 3),
        triangle_indices=np.arange(3 * len(triangles)).reshape(-1, 3),
        vertex_normals=np.repeat(normals, 3, axis=0),
        albedo_factor=colour,
    )
