"""Rough ground: an undulating height field with a level pad under the machine."""

from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.site.settings import TerrainSettings
from scipy.ndimage import gaussian_filter, map_coordinates

from executive.arrays import Float, Int, checked

TERRAIN = "terrain"
FIRM = "firm_ground"  # below the loose soil: only what digs meets it
_DIGS = 2  # contact group of what digs, and of the firm ground
_LEAST_ELEVATION_M = 1e-3  # MuJoCo requires a positive elevation, also of level ground
_UNSEEN = 4  # a group of geometries that no picture shows
_BEDROCK_M = 2.0  # thickness below the lowest point, so that nothing falls through


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Heights on a square grid around the origin of the world.

    Attributes:
        coordinates_m: Rising x (and y) coordinates of the grid [m], shape (n,).
        heights_m: Height at (x[i], y[j]) [m], shape (n, n).
        loose_m: Depth of the loose soil, which teeth pass [m].
    """

    coordinates_m: Float
    heights_m: Float
    loose_m: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "coordinates_m", checked("coordinates_m", self.coordinates_m, None)
        )
        n = len(self.coordinates_m)
        object.__setattr__(self, "heights_m", checked("heights_m", self.heights_m, n, n))

    def height_at(self, points_xy: Float) -> Float:
        """Return the bilinear height [m] at points (N, 2), shape (N,); constant beyond the edge."""
        cell = self.coordinates_m[1] - self.coordinates_m[0]
        indices = (np.asarray(points_xy) - self.coordinates_m[0]) / cell
        return np.asarray(map_coordinates(self.heights_m, indices.T, order=1, mode="nearest"))

    def mesh(self) -> tuple[Float, Int]:
        """Return vertices (V, 3) [m] and triangles (F, 3), counter-clockwise from above.

        Cells are split like those of MuJoCo.
        """
        n = len(self.coordinates_m)
        x, y = np.meshgrid(self.coordinates_m, self.coordinates_m, indexing="ij")
        index = np.arange(n * n).reshape(n, n)
        a, b, c, d = (
            part.ravel()
            for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
        )
        triangles = np.vstack([np.c_[a, b, c], np.c_[a, c, d]])
        return np.c_[x.ravel(), y.ravel(), self.heights_m.ravel()], triangles

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add the height field to a world, as the geometry `terrain`.

        Where soil is loose, bodies that `dig` pass it and meet `firm_ground` below it.
        """
        half, n = float(self.coordinates_m[-1]), len(self.coordinates_m)
        lowest = float(self.heights_m.min())
        elevation = max(float(np.ptp(self.heights_m)), _LEAST_ELEVATION_M)
        spec.add_hfield(
            name=TERRAIN,
            nrow=n,
            ncol=n,
            size=[half, half, elevation, _BEDROCK_M],
            userdata=((self.heights_m - lowest) / elevation).T.ravel(),  # rows run along y
        )
        surface = spec.worldbody.add_geom(
            name=TERRAIN,
            type=mujoco.mjtGeom.mjGEOM_HFIELD,
            hfieldname=TERRAIN,
            pos=[0.0, 0.0, lowest],
            rgba=[0.55, 0.47, 0.36, 1.0],
        )
        if self.loose_m > 0:
            surface.contype = 0  # it touches what touches group 1 by itself, which teeth do not
            spec.worldbody.add_geom(
                name=FIRM,
                type=mujoco.mjtGeom.mjGEOM_HFIELD,
                hfieldname=TERRAIN,
                pos=[0.0, 0.0, lowest - self.loose_m],
                contype=0,
                conaffinity=_DIGS,
                group=_UNSEEN,
            )


def let_dig(body: mujoco.MjsBody) -> None:
    """Let a body pass loose soil; it touches all else as before."""
    for geom in body.geoms:
        geom.contype = _DIGS


def make_terrain(settings: TerrainSettings, rng: np.random.Generator) -> Terrain:
    """Draw a terrain: long waves plus roughness, both Gaussian random fields, on a plane.

    All fade out towards the pad of the machine: on a slope, a terrace is cut for it.
    """
    n = 2 * round(settings.half_size_m / settings.cell_m) + 1
    coordinates = np.linspace(-settings.half_size_m, settings.half_size_m, n)
    # A wave is about four kernel widths long.
    waves = _field(n, settings.wavelength_m / 4 / settings.cell_m, rng)
    clods = _field(n, 1.0, rng)
    fade = _fade(coordinates, settings.pad_radius_m)
    heights = settings.undulation_m * fade * waves + settings.roughness_m * fade * clods
    if settings.slope_rad > 0:
        heights += fade * _hillside(coordinates, settings.slope_rad, settings.uphill_rad)
    return Terrain(coordinates, heights, settings.loose_m)


def _field(n: int, kernel_cells: float, rng: np.random.Generator) -> Float:
    noise = gaussian_filter(rng.standard_normal((n, n)), kernel_cells, mode="wrap")
    noise -= noise.mean()
    return np.asarray(noise / noise.std())


def _hillside(coordinates_m: Float, slope_rad: float, uphill_rad: float) -> Float:
    """Return the heights of a plane through the origin that rises in a direction [m], (n, n)."""
    along = (
        np.cos(uphill_rad) * coordinates_m[:, None] + np.sin(uphill_rad) * coordinates_m[None, :]
    )
    return np.asarray(np.tan(slope_rad) * along)


def _fade(coordinates_m: Float, pad_radius_m: float) -> Float:
    """Return 0 on the pad, 1 from 1.5 m beyond it, and a smooth step (3u² − 2u³) between."""
    radius = np.hypot(coordinates_m[:, None], coordinates_m[None, :])
    u = np.clip((radius - pad_radius_m) / 1.5, 0, 1)
    return np.asarray(u * u * (3 - 2 * u))
