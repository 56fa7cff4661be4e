"""Fit a lying stone's model to the newest map: the step that leaves which look at stones share."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.registration import Registrar
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.surroundings import unexplained
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone


class FittingSettings(Settings):
    margin: Meters = Field(
        0.5, gt=0, le=2, description="Margin of the map around the model for the alignment [m]."
    )
    max_distance: Meters = Field(0.3, gt=0, le=2, description="Farthest correspondence [m].")
    max_shift: Meters = Field(
        0.5, gt=0, le=2, description="A larger correction by alignment is refused [m]."
    )
    search_radius: Meters = Field(
        2.0, gt=0, le=10, description="Radius of the search for a stone that was lost [m]."
    )


@dataclass(frozen=True, slots=True)
class Fitted:
    """What came of a fit.

    Attributes:
        method: `alignment` or `registration`.
        alignment: Motion of the stone in the map, from where the database has it.
        refusal: Why neither method saw the stone; empty if one did.
    """

    method: str
    alignment: Alignment
    refusal: str

    def shift_m(self, stone: Stone) -> float:
        """Return how far the motion takes the stone's centroid [m]."""
        moved = self.alignment.apply(stone.centroid_map[None])[0]
        return float(np.linalg.norm(moved - stone.centroid_map))


def fit(
    context: Context, stone: Stone, settings: FittingSettings
) -> Generator[Job[Alignment], Any, Fitted]:
    """Align the model with the map around it; beyond the aligner's basin, register it.

    Args:
        context: The leaf's view of the mission; it needs mapping, alignment, registration and
            objects.
        stone: The stone as the database has it.
        settings: Margins and gates.
    """
    source = Cloud("map", stone.points_map)
    low = stone.points_map.min(axis=0) - settings.margin
    high = stone.points_map.max(axis=0) + settings.margin
    around = context.use(Mapper).cloud().in_box(low, high)
    aligner = context.use(Aligner)
    aligned = yield from context.job(
        aligner.align, around, source, np.eye(4), settings.max_distance
    )
    refusal = "" if aligned.accepted else aligned.reason
    shift_m = Fitted("alignment", aligned, "").shift_m(stone)
    if not refusal and shift_m > settings.max_shift:
        refusal = f"a correction of {shift_m:.2f} m is more than {settings.max_shift:.2f} m"
    if not refusal:
        return Fitted("alignment", aligned, "")
    wider = unexplained(context, stone.id, settings.search_radius)
    found = yield from context.job(context.use(Registrar).find, wider, source)
    if found.accepted:
        return Fitted("registration", found, "")
    return Fitted("alignment", aligned, f"{refusal}; registration: {found.reason}")
