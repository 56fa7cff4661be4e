"""Sites with more than stones on them: waves, slopes, walls, machines, stacks, a street."""

from dataclasses import dataclass
from types import ModuleType

import numpy as np
import open3d as o3d
from perception.piles import _labels
from scipy.spatial import ConvexHull

from executive.arrays import Float, Int
from executive.geometry.rotation import about_axis

RAYS = 260_000
_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Terrain:
    """Waves on a slope.

    Attributes:
        amplitude_m: Height of a crest above the mean [m].
        wavelength_m: From crest to crest [m].
        slope_rad: Of the mean plane [rad].
    """

    amplitude_m: float = 0.0
    wavelength_m: float = 8.0
    slope_rad: float = 0.0

    def heights(self, xy: Float) -> Float:
        """Return the ground's height at places [m], (N, 2) → (N,)."""
        k = 2 * np.pi / self.wavelength_m
        waves = self.amplitude_m * np.sin(k * xy[:, 0]) * np.cos(0.7 * k * xy[:, 1])
        return np.asarray(waves + np.tan(self.slope_rad) * xy[:, 0])

    def crest_near(self, spot: Float) -> Float:
        """Return the crest nearest to a place [m], shape (2,); the place where there are none."""
        if not self.amplitude_m:
            return spot
        period = np.array([self.wavelength_m, self.wavelength_m / 0.7])
        first = np.array([period[0] / 4, 0.0])
        return np.asarray(first + np.rint((spot - first) / period) * period)


@dataclass(frozen=True, slots=True, eq=False)
class DrawnSite:
    """A cloud, and what each of its points is of.

    Attributes:
        points: [m], shape (N, 3).
        labels: 0: ground; k: thing k − 1, shape (N,).
        things: What each thing is: `stone`, `wall`, `machine`, `stack`, `boulder`, `pebble`, ….
    """

    points: Float
    labels: Int
    things: tuple[str, ...]


class SiteDraft:
    """Gathers ground and things, and looks at them as a drone does."""

    def __init__(
        self, scenes: ModuleType, rng: np.random.Generator, terrain: Terrain, half_m: float = 8.0
    ) -> None:
        self._scenes, self._rng, self._terrain, self._half_m = scenes, rng, terrain, half_m
        self._scene = o3d.t.geometry.RaycastingScene()
        self._things: list[str] = []
        self._numbers: list[int] = []
        count = int(20 * half_m) + 1
        axis = np.linspace(-half_m - 2, half_m + 2, count)
        xy = np.array(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1).T
        corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()[:, None]
        faces = np.vstack([corner + [0, count, count + 1], corner + [0, count + 1, 1]])
        self._mesh(np.column_stack([xy, terrain.heights(xy) + rng.normal(0, 0.01, len(xy))]), faces)

    def add(self, what: str, corners: Float, spot: Float, *, sunk_m: float = 0.05) -> None:
        """Set the convex hull of corners onto the ground at a spot (x, y) [m]."""
        foot = self._terrain.heights(np.asarray(spot, dtype=float)[None])[0]
        self.join(what, corners + [*spot, foot - corners[:, 2].min() - sunk_m])

    def join(self, what: str, *hulls: Float) -> None:
        """Add one thing made of hulls, corners in the site's frame [m]."""
        self._things.append(what)
        for corners in hulls:
            self._mesh(corners, ConvexHull(corners).simplices, len(self._things))

    def _mesh(self, corners: Float, faces: Int, number: int = 0) -> None:
        self._scenes._add(self._scene, corners, faces)
        self._numbers.append(number)

    def seen(self, rays: int = RAYS) -> DrawnSite:
        """Return what rays from above, aslant in all directions, show."""
        rng, half = self._rng, self._half_m
        aims = np.column_stack([rng.uniform(-half, half, (rays, 2)), np.zeros(rays)])
        aims[:, 2] = self._terrain.heights(aims[:, :2])
        azimuth, tilt = rng.integers(12, size=rays) * np.pi / 6, rng.uniform(0.1, 0.95, rays)
        away = np.column_stack(
            [np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)]
        )
        directions = -away
        points = self._scenes._seen(
            self._scene, aims + 13.0 * away, directions, rng.normal(0, 0.012, rays)
        )
        points = self._scenes._thin(points[np.abs(points[:, :2]).max(axis=1) < half], 0.03)
        return DrawnSite(
            points, np.array(self._numbers)[_labels(self._scene, points)], tuple(self._things)
        )


def box(size: tuple[float, float, float], yaw_rad: float = 0.0) -> Float:
    """Return the corners of a box that stands on z = 0 [m], shape (8, 3)."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)])
    return np.asarray((corners * size) @ about_axis(_Z, yaw_rad).T)
