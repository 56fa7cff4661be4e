"""Places at which a stone was let go before and did not stay.

What bears a stone there is not as the models tell, and it is the same for the next one.
"""

from collections.abc import Mapping

import numpy as np
from executive_plugins.placing.dry_stone.parts import Places
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop, raster_of
from executive_plugins.placing.dry_stone.settings import DryStoneSettings

from executive.arrays import Bool, Float, Int
from executive.messages.building import AsBuilt, FailedRelease


class FailedPlaces:
    """Ranks places at which a release failed lower, and leaves out those where several did."""

    def __init__(self, built: AsBuilt, settings: DryStoneSettings) -> None:
        """Take a structure, with the releases that failed."""
        cell_m, self._touch_m = settings.generator.cell, settings.generator.touch
        self._failed, self._settings = built.failed, settings.check
        self._wall = WallTop(built, cell_m) if built.failed else None
        self._names = np.array([one.stone.name for one in built.standing] + [""])

    def left(self, places: Places) -> tuple[Places, Mapping[str, Float]]:
        """Return the places of one orientation that are left, and a term of their scores."""
        if not self._failed:
            return places, {}
        count = self.counted(places)
        is_left = count < self._settings.failures
        term = -self._settings.doubt * count[is_left].astype(np.float64)
        return places.only(is_left), {"failed": term}

    def counted(self, places: Places) -> Int:
        """Return how many releases failed at each place, shape (P,).

        One did if its stone's middle was nearer than the radius of that stone, and if all that the
        new stone first touches bore that one, too. A place on a stone that was put there since is
        another, and so is one on the ground alone.
        """
        count = np.zeros(len(places.origins_map), dtype=np.int64)
        raster: StoneRaster | None = None
        for failed in self._failed:
            away = np.linalg.norm(places.origins_map[:, :2] - failed.at_map, axis=1)
            near = np.flatnonzero(away < failed.radius_m)
            if self._wall is None or not len(near):
                continue
            if raster is None:
                stone = places.stone
                raster = raster_of(stone.vertices, stone.triangles, places.R, self._wall.cell_m)
            count[near] += self._is_borne(self._wall, raster, places.origins_map[near], failed)
        return count

    def _is_borne(
        self, wall: WallTop, raster: StoneRaster, origins_map: Float, failed: FailedRelease
    ) -> Bool:
        """Return at which places a stone touches stones of a failed release, and no others."""
        is_support = np.isin(self._names, list(failed.supports))
        cells = np.argwhere(np.isfinite(raster.under))
        nodes = np.rint(origins_map[:, :2] / wall.cell_m).astype(np.int64) - wall.corner
        i, j = (nodes[:, None] + raster.first + cells).transpose(2, 0, 1)
        gaps = origins_map[:, 2:] + raster.under[tuple(cells.T)] - wall.top[i, j]
        is_touched = (gaps <= self._touch_m) & (wall.owner[i, j] >= 0)
        borne = is_support[wall.owner[i, j]]
        return np.asarray((is_touched & borne).any(axis=1) & ~(is_touched & ~borne).any(axis=1))
