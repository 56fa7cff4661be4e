"""Places from height maps: each stone on each broad side, turned, over all of the structure."""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.placing.dry_stone import drops as measured
from executive_plugins.placing.dry_stone.drops import DropRules, drops
from executive_plugins.placing.dry_stone.orientations import orientations
from executive_plugins.placing.dry_stone.parts import Places
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.settings import GeneratorSettings

from executive.arrays import Float
from executive.interfaces.building import MayGoOn
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone

_NAMES = {
    "contact_share": measured.CONTACT,
    "mean_gap_m": measured.VOID,
    "support_margin_m": measured.MARGIN,
    "largest_support_share": measured.SHARE,
    "outside_share": measured.OUTSIDE,
    "depth_m": measured.DEPTH,
    "top_m": measured.TOP,
    "beside_share": measured.BESIDE,
}


class HeightMaps:
    """The shipped generator (Furrer et al. 2017 sample poses; here all of them are measured)."""

    def __init__(self, settings: GeneratorSettings) -> None:
        self._settings = settings

    def places(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn,
    ) -> Iterator[Sequence[Places]]:
        """Yield the places of each stone within the envelope and supported below its centre."""
        wall = WallTop(built, self._settings.cell)
        heading = built.structure.heading_rad(built.structure.length_m / 2)
        highest_m = built.structure.height_m + self._over_top_m(inventory)
        for stone in inventory:
            if not may_go_on():
                return
            s = self._settings
            sides = None if s.attitude == "kept" else s.sides
            turned = orientations(stone.vertices, sides, s.turns, heading)
            yield [self._of_orientation(stone, R, wall, built, highest_m) for R in turned]

    def _over_top_m(self, inventory: Sequence[SolidStone]) -> float:
        """Return how far a stone may stand above the envelope [m].

        A stone fits below a top, or it does not: tops that end at most half a stone above the
        height end as far below it, and the structure is as high as is wanted in the mean.
        """
        if self._settings.over_top is not None:
            return self._settings.over_top
        return float(np.median([stone.extents_m[2] for stone in inventory])) / 2

    def _of_orientation(
        self, stone: SolidStone, R: Float, wall: WallTop, built: AsBuilt, highest_m: float
    ) -> Places:
        s, structure = self._settings, built.structure
        lean = float(np.tan(structure.batter_rad))
        right = lean if structure.faces == 2 else 0.0
        rules = DropRules(s.touch, lean, right, s.stride, s.most_outside)
        raster = raster_of(stone.vertices, stone.triangles, R, s.cell)
        nodes, found = drops(wall, raster, rules)
        fits = (
            (found[:, measured.OUTSIDE] <= s.most_outside)
            & (found[:, measured.TOP] <= highest_m)
            & (found[:, measured.MARGIN] > 0)
        )
        xy = (nodes[fits] + wall.corner) * s.cell
        origins = np.column_stack([xy, found[fits, measured.HEIGHT]])
        names = {name: found[fits, column] for name, column in _NAMES.items()}
        is_stone = np.isfinite(raster.under)
        foot_m2 = float(is_stone.sum()) * s.cell**2
        height_m = float(raster.over[is_stone].max() - raster.under[is_stone].min())
        names["void_m3"] = foot_m2 * names["mean_gap_m"]
        names["bottom_m"] = names["top_m"] - height_m
        return Places(stone, R, origins, names)
