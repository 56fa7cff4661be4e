"""The rough skin of a generated stone, which lidars see."""

import numpy as np
import open3d as o3d

from executive.arrays import Float, Int
from executive.geometry.hull_mesh import hull_mesh


def rough_skin(
    corners: Float, roughness_m: float, edge_m: float, rng: np.random.Generator
) -> tuple[Float, Int]:
    """Return a closed, bumpy mesh over a convex block: vertices (V, 3) [m], triangles (F, 3).

    Args:
        corners: Corners of the block [m], shape (N, 3).
        roughness_m: Standard deviation of the bumps along the outward direction [m].
        edge_m: Longest edge of the mesh, the size of the bumps [m].
        rng: Random generator of the bumps.
    """
    hull = hull_mesh(corners)
    mesh = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(hull[0]), o3d.utility.Vector3iVector(hull[1])
    )
    while _longest_edge_m(mesh) > edge_m:
        mesh = mesh.subdivide_midpoint(1)
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles).astype(np.int64)
    outward = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    bumps = rng.normal(0.0, roughness_m, len(vertices))
    return np.asarray(vertices + bumps[:, None] * outward), triangles


def _longest_edge_m(mesh: o3d.geometry.TriangleMesh) -> float:
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
    edges = corners - np.roll(corners, 1, axis=1)
    # The median over triangles: splitting for a few long slivers would give four times as many
    # triangles.
    return float(np.median(np.linalg.norm(edges, axis=2).max(axis=1)))
