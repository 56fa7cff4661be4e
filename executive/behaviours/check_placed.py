"""Ask whether placed stones are still where they were put."""

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float, Int
from executive.config import Meters
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Steps
from executive.leaf.fitting import Fitted, FittingSettings, fit
from executive.leaf.form_evidence import is_refuted
from executive.leaf.lost import mark_lost
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import map_cloud, unexplained
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState

_CELL_M = 0.25  # of the ground under a stone: some cells a side, each with many points if seen


class CheckPlacedSettings(FittingSettings):
    position: Meters = Field(
        0.3, gt=0, le=2, description="Largest distance of a stone's centre from its place [m]."
    )
    shown: float = Field(
        0.5,
        gt=0,
        le=1,
        description="Share of a stone's place that the map has to show, or the stone passes.",
    )


class CheckPlaced(Action[CheckPlacedSettings]):
    """Fit each placed stone's model to the newest map; one that the map refutes there is lost.

    It belongs after a scan: a stone that fell may have pushed those that stood, and a later stone
    may have moved an earlier one. What no scan has looked at since keeps its place in the map, and
    passes. So does a stone of whose place the map shows less than a share, not even ground: the
    machine has driven on, and the map with it; and one of which the map shows too little to
    confirm it, and nothing that refutes it. Such stones are counted in the reason.
    """

    needs = (Mapper, Aligner, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        missing, doubtful = [], 0
        cloud = yield from map_cloud(self.context)
        stones = self.context.use(ObjectDatabase).stones()
        placed = [stone for stone in stones if stone.state is StoneState.PLACED]
        mapped = yield from self.context.job(_mapped, placed, cloud, self.settings.shown)
        for stone in mapped:
            fitted = yield from fit(self.context, stone, self.settings)
            off_m = fitted.shift_m(stone)
            wrong = f"is not seen at its place: {fitted.refusal}" if fitted.refusal else ""
            if wrong and not (yield from self._is_refuted(stone, fitted)):
                doubtful += 1
                continue
            if not wrong and off_m > self.settings.position:
                wrong = f"is {off_m:.2f} m off its place"
            if wrong:
                mark_lost(self.context, stone.id, wrong)
                missing.append(f"stone {stone.id} {wrong}")
        if missing:
            return failed("; ".join(missing))
        beyond = len(placed) - len(mapped)
        told = f", {doubtful} are neither confirmed nor refuted" if doubtful else ""
        told += f", {beyond} are beyond the map" if beyond else ""
        return succeeded(reason=f"{len(mapped) - doubtful} stones are seen at their places{told}")

    def _is_refuted(self, stone: Stone, fitted: Fitted) -> Generator[Any, Any, bool]:
        """Ask of the surface where it was aligned: a stone with another on it has moved a little.

        The few centimetres by which it sank or turned, well within `position`, would be another
        form.
        """
        is_aligned = fitted.alignment.accepted and fitted.shift_m(stone) <= self.settings.position
        surface = stone.points_map
        if is_aligned:
            surface = fitted.alignment.apply(surface)
        radius_m = float(np.linalg.norm(np.ptp(stone.points_map[:, :2], axis=0)))
        around = yield from unexplained(self.context, stone.id, radius_m)
        return (yield from self.context.job(is_refuted, around, surface, self.settings))


def _mapped(stones: Sequence[Stone], cloud: Cloud, least: float) -> Sequence[Stone]:
    """Return the stones of whose places the map shows at least a share."""
    return [stone for stone in stones if _is_mapped(stone, cloud, least)]


def _is_mapped(stone: Stone, cloud: Cloud, least: float) -> bool:
    """Return whether the map shows a share of a stone's place: the stone, or the ground there.

    At the rim of the map a part of the place is missing, and so would a stone be that stands there.
    What hides behind the stone is missing, too, and is less than its half.
    """
    centre = stone.centroid_map[:2]
    radius_m = float(np.linalg.norm(stone.points_map[:, :2] - centre, axis=1).max())
    around = cloud.near(centre, radius_m + _CELL_M).points
    seen = {tuple(cell) for cell in _cells(around)}
    own = {tuple(cell) for cell in _cells(stone.points_map)}
    return len(own & seen) >= least * len(own)


def _cells(points_map: Float) -> Int:
    """Return the cells of the ground that have points (N, 3), shape (K, 2)."""
    return np.unique(np.floor(points_map[:, :2] / _CELL_M).astype(np.int64), axis=0)
