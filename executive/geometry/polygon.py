"""Simple polygons in the plane: area, containment, distances, and the smallest box around one."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, checked
from executive.errors import DataError


def area_m2(corners: Float) -> float:
    """Return the area of a polygon (N, 2) [m²], negative if its corners run clockwise."""
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def contains(corners: Float, points: Float) -> Bool:
    """Return which points (M, 2) lie in a simple polygon (N, 2), by the even-odd rule."""
    ends = np.roll(corners, -1, axis=0)
    x, y = points[:, :1], points[:, 1:2]
    is_spanned = (corners[:, 1] > y) != (ends[:, 1] > y)
    rise = np.where(ends[:, 1] == corners[:, 1], 1.0, ends[:, 1] - corners[:, 1])
    crossing = corners[:, 0] + (y - corners[:, 1]) / rise * (ends[:, 0] - corners[:, 0])
    return np.asarray((is_spanned & (x < crossing)).sum(axis=1) % 2 == 1)


def distance_to_outline(corners: Float, points: Float) -> Float:
    """Return the distance of each point (M, 2) from the border of a polygon (N, 2), shape (M,)."""
    along = np.roll(corners, -1, axis=0) - corners
    length2 = np.maximum((along**2).sum(axis=1), 1e-18)
    share = ((points[:, None, :] - corners) * along).sum(axis=2) / length2
    nearest = corners + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.asarray(np.linalg.norm(points[:, None, :] - nearest, axis=2).min(axis=1))


def outline_gap(one: Float, other: Float) -> float:
    """Return the distance between two simple polygons [m]; 0 where they touch or overlap."""
    if contains(one, other).any() or contains(other, one).any() or _edges_cross(one, other):
        return 0.0
    return float(min(distance_to_outline(one, other).min(), distance_to_outline(other, one).min()))


def outlines_touch(one: Float, other: Float, margin_m: float = 0.0) -> bool:
    """Return whether two simple polygons overlap or are as near to each other as a margin."""
    return outline_gap(one, other) <= margin_m


def crosses_itself(corners: Float) -> bool:
    """Return whether two edges of a polygon (N, 2) that are not neighbours cross."""
    ends = np.roll(corners, -1, axis=0)
    crossing = _crossings(corners, ends, corners, ends)
    number = np.arange(len(corners))
    apart = np.abs(number[:, None] - number)
    is_neighbour = (apart <= 1) | (apart == len(corners) - 1)
    return bool((crossing & ~is_neighbour).any())


def outline_of(points: Float) -> Float:
    """Return the convex outline of points from above, counter-clockwise, (N, 2 or 3) → (V, 2).

    Raises:
        DataError: If the points lie on one line.
    """
    from scipy.spatial import ConvexHull, QhullError  # slow to import, and few missions need it

    try:
        return np.asarray(points[ConvexHull(points[:, :2]).vertices, :2])
    except (QhullError, ValueError) as error:
        raise DataError(f"{len(points)} points have no outline from above") from error


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A rectangle in the plane.

    Attributes:
        centre: Its middle [m], shape (2,).
        length_m: Its longer side [m].
        width_m: Its shorter side [m].
        heading_rad: Direction of the longer side, from x towards y, in [−π/2, π/2) [rad].
    """

    centre: Float
    length_m: float
    width_m: float
    heading_rad: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", checked("centre", self.centre, 2))

    def corners(self) -> Float:
        """Return its corners, counter-clockwise, shape (4, 2)."""
        return rectangle(self.centre, self.length_m, self.width_m, self.heading_rad)


def rectangle(centre: Float, length_m: float, width_m: float, heading_rad: float) -> Float:
    """Return the corners of a rectangle whose length has a heading, shape (4, 2)."""
    along = np.array([np.cos(heading_rad), np.sin(heading_rad)]) * length_m / 2
    across = np.array([-np.sin(heading_rad), np.cos(heading_rad)]) * width_m / 2
    return np.asarray(
        [centre - along - across, centre + along - across, centre + along + across,
         centre - along + across]
    )  # fmt: skip


def smallest_box(outline: Float) -> Box:
    """Return the rectangle of least area around a convex outline (V, 2).

    One of its sides lies on an edge of the outline (Freeman & Shapira 1975), so each edge is tried.
    """
    edges = np.roll(outline, -1, axis=0) - outline
    headings = np.arctan2(edges[:, 1], edges[:, 0])
    along = np.column_stack([np.cos(headings), np.sin(headings)])
    across = np.column_stack([-along[:, 1], along[:, 0]])
    s, t = outline @ along.T, outline @ across.T  # (V, E): coordinates along and across each edge
    sides = np.ptp(s, axis=0), np.ptp(t, axis=0)
    best = int(np.argmin(sides[0] * sides[1]))
    middle = (s[:, best].max() + s[:, best].min()) / 2, (t[:, best].max() + t[:, best].min()) / 2
    centre = middle[0] * along[best] + middle[1] * across[best]
    length_m, width_m = float(sides[0][best]), float(sides[1][best])
    heading = float(headings[best]) + (np.pi / 2 if width_m > length_m else 0.0)
    heading = (heading + np.pi / 2) % np.pi - np.pi / 2
    return Box(centre, max(length_m, width_m), min(length_m, width_m), heading)


def _edges_cross(one: Float, other: Float) -> bool:
    ends = np.roll(one, -1, axis=0), np.roll(other, -1, axis=0)
    return bool(_crossings(one, ends[0], other, ends[1]).any())


def _crossings(a: Float, b: Float, c: Float, d: Float) -> Bool:
    """Return which edges a–b (N, 2) and c–d (M, 2) cross or touch, shape (N, M)."""

    def side(p: Float, q: Float, r: Float) -> Float:
        one, two = q - p, r - p
        return np.asarray(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])

    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    return np.asarray(
        (side(a, b, c) * side(a, b, d) <= 0) & (side(c, d, a) * side(c, d, b) <= 0)
        & _boxes_meet(a, b, c, d)
    )  # fmt: skip


def _boxes_meet(a: Float, b: Float, c: Float, d: Float) -> Bool:
    """Return where the boxes around two edges meet: edges on one line may lie apart."""
    return np.asarray(
        ((np.maximum(a, b) >= np.minimum(c, d)) & (np.maximum(c, d) >= np.minimum(a, b))).all(
            axis=-1
        )
    )
