"""Convex blocks like those from a quarry: bedding planes, joints, and cut corners.

The rock separates along two bedding planes and two sets of joints, nearly at right angles; blows
cut off corners and edges. The axes a ≥ b ≥ c lie along the joints and across the bedding. Their
ratios follow the statistics of found stones, b/a ~ N(0.76, 0.13) and c/b ~ N(0.70, 0.16), truncated
to exclude slabs and needles.
"""

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection

from executive.arrays import Float

_RATIO_B_A = (0.76, 0.13, 0.45, 1.0)  # mean, standard deviation, least and largest value
_RATIO_C_B = (0.70, 0.16, 0.40, 1.0)
_BEDDING_TILT = 0.05  # spread of a bedding plane's normal [rad]
_JOINT_TILT = 0.12  # spread of a joint's normal [rad]
_CUTS = (6, 13)  # number of blows: least, and largest plus one
_CUT_DEPTH = (0.68, 0.92)  # distance of a cut from the centre, over that of the box's corner


def ratios(rng: np.random.Generator) -> tuple[float, float]:
    """Draw b/a and c/b."""
    return _truncated(*_RATIO_B_A, rng), _truncated(*_RATIO_C_B, rng)


def _truncated(
    mean: float, std: float, least: float, most: float, rng: np.random.Generator
) -> float:
    while not least <= (value := rng.normal(mean, std)) <= most:
        pass
    return float(value)


def block(volume_m3: float, rng: np.random.Generator) -> Float:
    """Draw the corners of a convex block of a volume, around the middle of its box, (V, 3) [m].

    Its extents a, b, c are along x, y, z.
    """
    b_a, c_b = ratios(rng)
    planes = np.vstack([_partings(rng), _blows(rng)])
    corners = HalfspaceIntersection(planes, np.zeros(3)).intersections
    corners = corners[ConvexHull(corners).vertices]
    # Blows cut the sides unequally, so the extents are set afterwards, as a stone is measured.
    corners = (corners - corners.min(axis=0)) / np.ptp(corners, axis=0) - 0.5
    corners = corners * np.array([1.0, b_a, b_a * c_b])
    return np.asarray(corners * np.cbrt(volume_m3 / ConvexHull(corners).volume))


def _partings(rng: np.random.Generator) -> Float:
    """Return the six faces of the block as planes n·p + d ≤ 0 with |d| = 1, shape (6, 4)."""
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
    # Each blow is directed to a corner of the box; with a zero, to an edge or a face.
    towards = rng.choice([-1.0, 1.0], (n, 3)) * (rng.random((n, 3)) < 0.8)
    towards[~towards.any(axis=1)] = 1.0
    normals = towards + rng.normal(0.0, 0.25, (n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    support = np.abs(normals).sum(axis=1)  # support of the box with half side 1
    return np.asarray(np.c_[normals, -rng.uniform(*_CUT_DEPTH, n) * support])
