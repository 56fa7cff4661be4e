"""Places from height maps: each stone on each broad side, turned, over all of the structure."""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.placing.dry_stone import drops as measured
from executive_plugins.placing.dry_stone.drops import DropRules, drops, measured_at
from executive_plugins.placing.dry_stone.footing import Footing, Noise, footing
from executive_plugins.placing.dry_stone.jaw_room import has_room
from executive_plugins.placing.dry_stone.joints import Joints
from executive_plugins.placing.dry_stone.orientations import orientations
from executive_plugins.placing.dry_stone.parts import Place, Places
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop, raster_of
from executive_plugins.placing.dry_stone.resting import at_rest
from executive_plugins.placing.dry_stone.rolling import underside_of
from executive_plugins.placing.dry_stone.settings import GeneratorSettings

from executive.arrays import Float, Int
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
    "rise_m": measured.RISE,
}


class HeightMaps:
    """The shipped generator (Furrer et al. 2017 sample poses; here all of them are measured)."""

    def __init__(self, settings: GeneratorSettings) -> None:
        self._settings = settings
        self._seen: tuple[AsBuilt, WallTop, Joints] | None = None

    def places(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn,
    ) -> Iterator[Sequence[Places]]:
        """Yield the places of each stone within the envelope, supported where it first touches.

        Without `supported`, those that may only be when it has tilted, too.
        """
        wall = self._top_of(built)
        heading = built.structure.heading_rad(built.structure.length_m / 2)
        rules = self._rules(built, inventory)
        for stone in inventory:
            if not may_go_on():
                return
            s = self._settings
            sides = None if s.attitude == "kept" else s.sides
            turned = orientations(stone.vertices, sides, s.turns, heading)
            yield [self._of_orientation(stone, R, wall, rules) for R in turned]

    def _over_top_m(self, inventory: Sequence[SolidStone]) -> float:
        """Return how far a stone may stand above the envelope [m].

        A stone fits below a top, or it does not: tops that end at most half a stone above the
        height end as far below it, and the structure is as high as is wanted in the mean.
        """
        if self._settings.over_top is not None:
            return self._settings.over_top
        return float(np.median([stone.extents_m[2] for stone in inventory])) / 2

    def _of_orientation(
        self, stone: SolidStone, R: Float, wall: WallTop, rules: DropRules
    ) -> Places:
        raster = raster_of(stone.vertices, stone.triangles, R, self._settings.cell)
        least_m = 0.0 if self._settings.supported or not self._settings.tilts else -np.inf
        return self._fitting(stone, raster, *drops(wall, raster, rules), wall, rules, least_m)

    def at_rest(
        self, place: Place, built: AsBuilt, inventory: Sequence[SolidStone]
    ) -> Places | None:
        """Return a place in the tilt in which the stone rests there, measured anew.

        None if it tilts farther than is allowed, or does not fit then. It rolls there, and moves.
        """
        wall, T = self._top_of(built), place.T_map_stone
        node = np.rint(T[:2, 3] / wall.cell_m).astype(np.int64) - wall.corner
        most_rad = self._settings.most_lean_rad
        rest = at_rest(place.stone, T[:3, :3], node, wall, most_rad)
        if rest is None:
            return None
        raster, node = rest
        rules, nodes = self._rules(built, inventory), node[None]
        found = measured_at(nodes, wall, raster, rules)
        fitting = self._fitting(place.stone, raster, nodes, found, wall, rules, 0.0)
        return fitting if len(fitting.origins_map) else None

    def footing(self, place: Place, built: AsBuilt, noise: Noise, most_rad: float) -> Footing:
        """Return how the stone will stand at a place; beyond a tilt, that it is lost."""
        wall, T = self._top_of(built), place.T_map_stone
        stone = place.stone
        raster = raster_of(stone.vertices, stone.triangles, T[:3, :3], wall.cell_m)
        return footing(underside_of(raster, wall.cell_m), wall, T[:2, 3], noise, most_rad)

    def _top_of(self, built: AsBuilt) -> WallTop:
        if self._seen is None or self._seen[0] is not built:
            top = WallTop(built, self._settings.cell, self._settings.astray)
            self._seen = built, top, Joints(built)
        return self._seen[1]

    def _rules(self, built: AsBuilt, inventory: Sequence[SolidStone]) -> DropRules:
        s, structure = self._settings, built.structure
        lean = float(np.tan(structure.batter_rad))
        right = lean if structure.faces == 2 else 0.0
        highest_m = structure.height_m + self._over_top_m(inventory)
        return DropRules(s.touch, lean, right, s.stride, s.most_outside, highest_m, s.most_rise)

    def _fitting(
        self,
        stone: SolidStone,
        raster: StoneRaster,
        nodes: Int,
        found: Float,
        wall: WallTop,
        rules: DropRules,
        least_margin_m: float,
    ) -> Places:
        """Return the places of one orientation that are in the envelope and supported."""
        fits = (
            (found[:, measured.OUTSIDE] <= rules.most_outside)
            & (found[:, measured.TOP] <= rules.highest_m)
            & (found[:, measured.MARGIN] > least_margin_m)
            & (found[:, measured.RISE] <= rules.most_rise_m)
        )
        if stone.jaws:
            heights_m = found[fits, measured.HEIGHT]
            fits[fits] = has_room(wall, nodes[fits], heights_m, stone.jaws, raster.R)
        xy = (nodes[fits] + wall.corner) * wall.cell_m
        origins = np.column_stack([xy, found[fits, measured.HEIGHT]])
        names = {name: found[fits, column] for name, column in _NAMES.items()}
        is_stone = np.isfinite(raster.under)
        foot_m2 = float(is_stone.sum()) * wall.cell_m**2
        height_m = float(raster.over[is_stone].max() - raster.under[is_stone].min())
        names["void_m3"] = foot_m2 * names["mean_gap_m"]
        names["bottom_m"] = names["top_m"] - height_m
        over = raster.over[is_stone]
        names["top_gap_m"] = np.full(len(origins), over.max() - over.mean())
        if self._seen is not None:
            joints = self._seen[2]
            names["joints_closed"] = joints.closed(origins, raster.R, stone.vertices)
            names["along_m"] = joints.lengths_m(origins, raster.R, stone.vertices)
            left = joints.left_m(origins, raster.R, stone.vertices)
            names["before_m"], names["after_m"] = left.T
        return Places(stone, raster.R, origins, names)
