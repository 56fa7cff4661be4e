"""Orientations that are worth a try: a stone on each of its broad sides, turned about the vertical.

A stone comes to rest on a face of its convex hull that its centre of mass is above; the share of
directions that lead there, by Goldberg 1999, is close to the solid angle of the face. Dry-stone
builders lay a stone on its broadest side, too.
"""

import numpy as np
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.rotation import about_axis

_ALIKE_RAD = 0.35  # two sides whose normals are closer are one
_UP = np.array([0.0, 0.0, 1.0])


def orientations(vertices: Float, sides: int | None, turns: int, first_rad: float) -> list[Float]:
    """Return rotations (3, 3) that lay a stone on its broadest sides, broadest first.

    Args:
        vertices: The surface about the centre of mass [m], shape (V, 3).
        sides: Number of sides; None keeps the stone as it lies in its own frame.
        turns: Number of turns about the vertical, even over a circle.
        first_rad: Heading of the stone's longer side from above at the first turn [rad].
    """
    found = []
    for R in _laid(vertices, sides):
        level = about_axis(_UP, first_rad - _heading_rad((vertices @ R.T)[:, :2]))
        found += [about_axis(_UP, 2 * np.pi * k / turns) @ level @ R for k in range(turns)]
    return found


def _heading_rad(xy: Float) -> float:
    """Return the heading of the longer side of the smallest rectangle around points (V, 2) [rad].

    One of its sides goes through two neighbours of their convex hull (Freeman and Shapira 1975).
    """
    corners = xy[ConvexHull(xy).vertices]
    edges = np.roll(corners, -1, axis=0) - corners
    along = edges / np.linalg.norm(edges, axis=1, keepdims=True)  # (E, 2)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    sides = np.stack([np.ptp(corners @ along.T, axis=0), np.ptp(corners @ across.T, axis=0)])
    best = int(np.argmin(sides.prod(axis=0)))
    longer = along[best] if sides[0, best] >= sides[1, best] else across[best]
    return float(np.arctan2(longer[1], longer[0]))


def _laid(vertices: Float, sides: int | None) -> list[Float]:
    """Return the rotations that lay a stone on its sides, before it is turned."""
    if sides is None:
        return [np.eye(3)]
    return [_turned_down(down) for down in _broad_sides(vertices, sides)]


def _broad_sides(vertices: Float, count: int) -> list[Float]:
    """Return the outward normals of the sides of largest area, faces alike taken together."""
    hull = ConvexHull(vertices)
    corners = vertices[hull.simplices]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    normals = hull.equations[:, :3]
    # The area that faces within the angle of each normal, nearer ones counting more.
    near = np.clip((normals @ normals.T - np.cos(_ALIKE_RAD)) / (1 - np.cos(_ALIKE_RAD)), 0, 1)
    breadth = near @ areas
    chosen: list[Float] = []
    for number in np.argsort(-breadth, kind="stable"):
        if all(normals[number] @ other < np.cos(_ALIKE_RAD) for other in chosen):
            mean = (near[number] * areas) @ normals
            chosen.append(mean / np.linalg.norm(mean))
        if len(chosen) == count:
            break
    return chosen


def _turned_down(normal: Float) -> Float:
    """Return the smallest rotation that turns a direction straight down."""
    axis = np.cross(normal, -_UP)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return np.eye(3) if normal[2] < 0 else about_axis(np.array([1.0, 0.0, 0.0]), np.pi)
    return about_axis(axis / sine, float(np.arctan2(sine, -normal[2])))
