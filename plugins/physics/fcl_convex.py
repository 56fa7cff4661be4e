"""Convex bodies for the collision library FCL."""

import fcl
import numpy as np

from executive.arrays import Float, Int


def fcl_convex(corners: Float, triangles: Int) -> fcl.Convex:
    """Return a convex polyhedron for FCL from the mesh of its surface, see `hull_mesh`."""
    faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    return fcl.Convex(corners, len(triangles), faces)
