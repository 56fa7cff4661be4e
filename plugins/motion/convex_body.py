"""Convex bodies of the machine and of a held stone, for collision checks."""

from dataclasses import dataclass
from functools import cached_property
from threading import Lock

import fcl
import numpy as np
from executive_plugins.physics.fcl_convex import fcl_convex
from scipy.spatial import ConvexHull, QhullError

from executive.arrays import Float, Int
from executive.errors import ShapeError
from executive.geometry.hull_mesh import mesh_of

PLACING = Lock()  # a verb that is overdue computes on in a thread of its own, beside the next one
_SPACING_M = 0.12  # largest distance between samples of a surface


@dataclass(frozen=True, eq=False)
class ConvexBody:
    """The convex hull of points that are fixed to a link.

    Attributes:
        link: Name of the link that carries it.
        points: Points in the frame of the link [m], shape (V, 3), not all in one plane.
        name: Name used in messages.
    """

    link: str
    points: Float
    name: str

    @cached_property
    def _hull(self) -> ConvexHull:
        try:
            return ConvexHull(self.points)
        except (QhullError, ValueError) as error:
            raise ShapeError(
                f"{self.name}: {len(self.points)} points that span no volume: {error}"
            ) from None

    @cached_property
    def _mesh(self) -> tuple[Float, Int]:
        return mesh_of(self._hull)

    @property
    def corners(self) -> Float:
        """Corners of the hull [m], shape (C, 3)."""
        return self._mesh[0]

    @property
    def faces(self) -> Int:
        """Triangles as indices of corners, counter-clockwise from outside, shape (F, 3)."""
        return self._mesh[1]

    @cached_property
    def sphere(self) -> tuple[Float, float]:
        """Centre (3,) and radius [m] of an enclosing sphere."""
        centre = (self.corners.min(axis=0) + self.corners.max(axis=0)) / 2
        return centre, float(np.linalg.norm(self.corners - centre, axis=1).max())

    @cached_property
    def thickness_m(self) -> float:
        """Depth of its middle [m], about half of its least extent."""
        return float(self.depths(self.corners.mean(axis=0)[None])[0])

    @cached_property
    def half_spaces(self) -> Float:
        """Faces (n, d), shape (F, 4); a point p is inside if n·p + d ≤ 0 for all of them.

        Coplanar triangles give one face.
        """
        return np.unique(np.round(self._hull.equations, 9), axis=0)

    @cached_property
    def placed(self) -> fcl.CollisionObject:
        """The body for the collision library, one for all checks: each object made leaks 32 bytes.

        Whoever sets its pose and asks for distances holds `PLACING` meanwhile.
        """
        return fcl.CollisionObject(fcl_convex(*self._mesh))

    def depths(self, points_link: Float) -> Float:
        """Return how deep points (N, 3) are inside, negative outside [m], shape (N,)."""
        H = self.half_spaces
        return np.asarray(-(points_link @ H[:, :3].T + H[:, 3]).max(axis=1))

    @cached_property
    def samples(self) -> Float:
        """Points that cover the surface, at most 12 cm apart, shape (N, 3)."""
        triangles = self.corners[self.faces]
        sides = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
        splits = np.ceil(sides / _SPACING_M).astype(np.int64)
        samples = [
            np.einsum("wc,fcx->fwx", _weights(n), triangles[splits == n]) for n in np.unique(splits)
        ]
        points = np.vstack([part.reshape(-1, 3) for part in samples])
        _, first = np.unique(np.round(points / (_SPACING_M / 2)), axis=0, return_index=True)
        return np.asarray(points[np.sort(first)])


def _weights(splits: int) -> Float:
    """Return barycentric weights of a grid that splits each triangle side evenly, shape (W, 3)."""
    i, j = np.mgrid[: splits + 1, : splits + 1]
    return np.asarray(np.stack([i, j, splits - i - j], axis=-1)[i + j <= splits] / splits)
