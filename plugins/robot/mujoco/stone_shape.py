"""Quarried blocks: bedding planes, joints, cut corners, and a rough skin.

The rock parts along two bedding planes and two sets of joints, nearly square to each other; blows take corners and
edges off. Axes a ≥ b ≥ c lie along the joints and across the bedding; their ratios follow the issue's statistics of
found stones, b/a ~ N(0.76, 0.13) and c/b ~ N(0.70, 0.16), cut off where a slab or a needle would begin.
"""

import numpy as np
import open3d as o3d
from scipy.spatial import ConvexHull, HalfspaceIntersection

from executive.arrays import Float, Int
from plugins.robot.mujoco.convex_mesh import hull_mesh

_RATIO_B_A = (0.76, 0.13, 0.45, 1.0)  # mean, standard deviation, least, most
_RATIO_C_B = (0.70, 0.16, 0.40, 1.0)
_BEDDING_TILT = 0.05  # spread of a bedding plane's normal [rad]
_JOINT_TILT = 0.12  # spread of a joint's normal [rad]
_CUTS = (6, 13)  # number of blows, least and one more than most
_CUT_DEPTH = (0.68, 0.92)  # of the way from the centre to the corner of the box


def ratios(rng: np.random.Generator) -> tuple[float, float]:
    """Draw b/a and c/b."""
    return _truncated(*_RATIO_B_A, rng), _truncated(*_RATIO_C_B, rng)


def _truncated(mean: float, std: float, least: float, most: float, rng: np.random.Generator) -> float:
    while not least <= (value := rng.normal(mean, std)) <= most:
        pass
    return float(value)


def block(volume_m3: float, rng: np.random.Generator) -> Float:
    """Return the corners of a convex block about its middle, extents a, b, c along x, y, z, shape (V, 3) [m]."""
    b_a, c_b = ratios(rng)
    planes = np.vstack([_partings(rng), _blows(rng)])
    corners = HalfspaceIntersection(planes, np.zeros(3)).intersections
    corners = corners[ConvexHull(corners).vertices]
    # Blows take more off one side than off another: the extents are set after them, as one would measure a stone.
    corners = (corners - corners.min(axis=0)) / np.ptp(corners, axis=0) - 0.5
    corners = corners * np.array([1.0, b_a, b_a * c_b])
    return np.asarray(corners * np.cbrt(volume_m3 / ConvexHull(corners).volume))


def _partings(rng: np.random.Generator) -> Float:
    """Return the six faces of the block, n·p + d ≤ 0 with |d| = 1, shape (6, 4)."""
    faces = []
    for axis, tilt in ((0, _JOINT_TILT), (1, _JOINT_TILT), (2, _BEDDING_TILT)):
        for sign in (-1.0, 1.0):
            normal = rng.normal(0.0, tilt, 3)
            normal[axis] = sign
            faces.append([*(normal / np.linalg.norm(normal)), -1.0])
    return np.array(faces)


def _blows(rng: np.random.Generator) -> Float:
    """Return planes that cut corners and edges, shape (n, 4)."""
    n = int(rng.integers(*_CUTS))
    towards = rng.choice([-1.0, 1.0], (n, 3)) * (rng.random((n, 3)) < 0.8)  # a zero makes a corner an edge or a face
    towards[~towards.any(axis=1)] = 1.0
    normals = towards + rng.normal(0.0, 0.25, (n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    support = np.abs(normals).sum(axis=1)  # of the box of half side 1
    return np.asarray(np.c_[normals, -rng.uniform(*_CUT_DEPTH, n) * support])


def rough_skin(corners: Float, roughness_m: float, edge_m: float, rng: np.random.Generator) -> tuple[Float, Int]:
    """Return a closed mesh over a convex block whose faces are bumpy: vertices (V, 3) [m], triangles (F, 3).

    Args:
        corners: Of the block [m], shape (N, 3).
        roughness_m: Standard deviation of the bumps along the outward direction [m].
        edge_m: Longest edge of the mesh, the size of the bumps [m].
        rng: Chance.
    """
    hull = hull_mesh(corners)
    mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(hull[0]), o3d.utility.Vector3iVector(hull[1]))
    while _longest_edge_m(mesh) > edge_m:
        mesh = mesh.subdivide_midpoint(1)
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles).astype(np.int64)
    outward = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    bumps = rng.normal(0.0, roughness_m, len(vertices))
    return np.asarray(vertices + bumps[:, None] * outward), triangles


def _longest_edge_m(mesh: o3d.geometry.TriangleMesh) -> float:
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
    edges = corners - np.roll(corners, 1, axis=1)
    # The median of the triangles' longest edges: a few long slivers are not worth four times the triangles.
    return float(np.median(np.linalg.norm(edges, axis=2).max(axis=1)))
