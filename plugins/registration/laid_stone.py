"""One stone's points on the surface of a stone of the other cloud, under some motion."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from executive_plugins.registration.similarity import Surface
from executive_plugins.registration.site_view import SiteView

from executive.arrays import Bool, Float, Int


@dataclass(frozen=True, eq=False)
class LaidStone:
    """Which points of a stone are near the surface of another, and how high above it.

    Attributes:
        surface: Of the other stone.
        view: The cloud of the other stone.
        points: In the frame of that cloud [m], shape (N, 3).
        is_near: Which of them are near the surface, shape (N,).
        feet: Row of the nearest point of the surface for each that is near, shape (M,).
    """

    surface: Surface
    view: SiteView
    points: Float
    is_near: Bool
    feet: Int

    @classmethod
    def on(cls, surface: Surface, view: SiteView, points: Float, reach_m: float) -> "LaidStone":
        """Look up which points are nearer than a reach [m]."""
        distances, rows = surface.nearest(points, reach_m)
        is_near = np.isfinite(distances)
        return cls(surface, view, points, is_near, rows[is_near])

    @cached_property
    def share(self) -> float:
        """Share of the points that are near, 0 … 1."""
        return len(self.feet) / max(len(self.points), 1)

    @cached_property
    def heights_m(self) -> Float:
        """How high the points that are near are above the surface [m], shape (M,)."""
        offsets = self.points[self.is_near] - self.surface.points[self.feet]
        return np.asarray(np.einsum("ij,ij->i", offsets, self.surface.normals[self.feet]))

    def residuals_m(self, margin_m: float) -> Float:
        """Return the heights of the points that are an observation [m], in their order.

        A point that is not near is one, of infinite height, only where the other cloud shows that
        nothing is within a margin [m].
        """
        heights = np.full(len(self.points), np.inf)
        heights[self.is_near] = self.heights_m
        is_seen, others = self.is_near.copy(), ~self.is_near
        is_seen[others] = self.view.is_open(self.points[others], margin_m)
        return heights[is_seen]
