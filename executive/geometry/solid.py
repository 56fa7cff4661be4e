"""Mass properties of a closed triangle mesh."""

import numpy as np

from executive.arrays import Float, Int

# Second moments ∫ x xᵀ dV of the tetrahedron with corners 0, e₁, e₂, e₃ are this over 120 (Blow &
# Binstock 2004).
_UNIT_MOMENTS = np.ones((3, 3)) + np.eye(3)


def volume_and_centroid(vertices: Float, triangles: Int) -> tuple[float, Float]:
    """Return volume [m³], negative for an inverted mesh, and its centroid [m], shape (3,)."""
    corners = vertices[triangles]
    six_volumes = np.linalg.det(corners)
    volume = six_volumes.sum() / 6
    return float(volume), (six_volumes[:, None] * corners.sum(axis=1)).sum(axis=0) / (24 * volume)


def inertia_about_origin(vertices: Float, triangles: Int, density_kg_m3: float) -> Float:
    """Return the inertia of a homogeneous solid about the origin [kg·m²], shape (3, 3)."""
    corners = vertices[triangles]
    moments = (
        np.einsum("n,nia,ij,njb->ab", np.linalg.det(corners), corners, _UNIT_MOMENTS, corners) / 120
    )
    return density_kg_m3 * np.asarray(np.trace(moments) * np.eye(3) - moments)


def is_closed(triangles: Int) -> bool:
    """Return whether each edge joins two triangles (F, 3) that run along it in opposite directions.

    Such a mesh bounds a volume, and all of its triangles face to the same side of the surface.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    code = np.array([edges.max() + 1, 1])
    along, back = edges @ code, edges[:, ::-1] @ code
    return len(np.unique(along)) == len(along) and bool(np.isin(along, back).all())
