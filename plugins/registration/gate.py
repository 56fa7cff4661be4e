"""Measures by which a registration is accepted: how closely and how far surfaces coincide.

The number of matched centroids or of inliers is not enough: wrong motions have matched four to
seven stones. So surfaces are compared.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.stopwatch import Stopwatch
from executive_plugins.registration.thinning import thinned

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid
from executive.messages.alignment import Alignment

_CELL = 3.0  # edge of the cells in which points are looked up, in that of the thinning


@dataclass(frozen=True, slots=True)
class Nearness:
    """Distances of one surface's points from another surface.

    Attributes:
        points: Number of points.
        near: Number of those nearer than the truncation.
        squares_m2: Sum of their squared distances [m²].
    """

    points: int
    near: int
    squares_m2: float

    def __add__(self, other: "Nearness") -> "Nearness":
        return Nearness(
            self.points + other.points, self.near + other.near, self.squares_m2 + other.squares_m2
        )

    @property
    def share(self) -> float:
        """Share of the points that are near, 0 … 1."""
        return self.near / self.points if self.points else 0.0

    @property
    def rmse_m(self) -> float:
        """Root mean square distance of the near points [m]; 0 if there is none."""
        return float(np.sqrt(self.squares_m2 / self.near)) if self.near else 0.0


@dataclass(frozen=True, slots=True)
class Agreement:
    """How a source surface lies on a target surface, and the target on the source."""

    source: Nearness
    target: Nearness

    @property
    def better(self) -> Nearness:
        """The direction of comparison with the larger share.

        All of a view from one side lies on the whole stone, but not the other way round. A view of
        another stone has a small share in both directions.
        """
        return max(self.source, self.target, key=lambda way: way.share)

    def __add__(self, other: "Agreement") -> "Agreement":
        return Agreement(self.source + other.source, self.target + other.target)

    def __str__(self) -> str:
        best = self.better
        return (
            f"rmse {best.rmse_m * 100:.1f} cm, overlap {self.source.share:.2f}, coverage "
            f"{self.target.share:.2f}"
        )


NOTHING = Agreement(Nearness(0, 0, 0.0), Nearness(0, 0, 0.0))


def measure(target: Float, moved: Float, truncation_m: float, voxel_m: float) -> Agreement:
    """Compare two sets of points in both directions, after thinning both to one density."""
    a, b = thinned(target, voxel_m), thinned(moved, voxel_m)
    ways = ((b, a), (a, b))
    return Agreement(*(_near(*way, truncation_m, _CELL * voxel_m) for way in ways))


def refusal(reason: str, watch: Stopwatch) -> Alignment:
    """Return the alignment that says why there is none."""
    return Alignment(np.eye(4), False, reason, 0.0, 0.0, timings_ms=watch.timings_ms())


def _near(points: Float, surface: Float, truncation_m: float, cell_m: float) -> Nearness:
    distances, _ = PointGrid(surface, cell_m).nearest(points, truncation_m)
    near = distances[np.isfinite(distances)]
    return Nearness(len(points), len(near), float(near @ near))
