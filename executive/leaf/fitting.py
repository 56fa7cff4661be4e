"""Fit a lying stone's model to the newest map: the step that leaves which look at stones share."""

from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np
from pydantic import Field

from executive.config import Meters
from executive.interfaces.alignment import Aligner
from executive.interfaces.registration import Registrar
from executive.leaf.context import Context
from executive.leaf.form_evidence import FormSettings, form_refusal
from executive.leaf.job import Job
from executive.leaf.surroundings import unexplained
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone


class FittingSettings(FormSettings):
    margin: Meters = Field(
        0.5, gt=0, le=2, description="Margin of the map around the model for the alignment [m]."
    )
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
) -> Generator[Job[object], object, Fitted]:
    """Align the model with the map around it; beyond the aligner's basin, register it.

    Points that lie on the models of other known stones are left out of the map: those of a stone
    that this one stands on, or that stands on it, lie near the parts of the model that are hidden,
    and would count as the model's own surface seen out of place.

    Args:
        context: The leaf's view of the mission; it needs mapping, alignment, registration and
            objects.
        stone: The stone as the database has it.
        settings: Margins and gates.
    """
    source = Cloud("map", stone.points_map)
    low = stone.points_map.min(axis=0) - settings.margin
    high = stone.points_map.max(axis=0) + settings.margin
    diagonal_m = float(np.hypot(*(high - low)[:2]))  # the centroid may be anywhere in the box
    around = (yield from unexplained(context, stone.id, diagonal_m)).in_box(low, high)
    aligner = context.use(Aligner)
    aligned = yield from context.job(
        aligner.align, around, source, np.eye(4), settings.max_distance
    )
    refusal = "" if aligned.accepted else aligned.reason
    shift_m = Fitted("alignment", aligned, "").shift_m(stone)
    if not refusal and shift_m > settings.max_shift:
        refusal = f"a correction of {shift_m:.2f} m is more than {settings.max_shift:.2f} m"
    if not refusal:
        surface = aligned.apply(stone.points_map)
        refusal = yield from context.job(form_refusal, around, surface, settings, True)
    if not refusal:
        return Fitted("alignment", aligned, "")
    wider = yield from unexplained(context, stone.id, settings.search_radius)
    found = yield from registered(context, wider, source, settings)
    if found.accepted:
        return Fitted("registration", found, "")
    return Fitted("alignment", aligned, f"{refusal}; registration: {found.reason}")


def registered(
    context: Context, around: Cloud, model: Cloud, settings: FormSettings
) -> Generator[Job[object], object, Alignment]:
    """Register a stone's model, and refuse a motion under which the map shows another surface.

    A stone that was turned over shows its underside, which nobody has seen. Turned back, its model
    lies within some two centimetres of what the map shows if the stone is a block, near enough for
    registration: only its form tells that this is not the known surface.

    Args:
        context: The leaf's view of the mission; it needs registration.
        around: The map without what other known stones explain.
        model: The stone's known surface.
        settings: How likely the form has to be.
    """
    found = yield from context.job(context.use(Registrar).find, around, model)
    if not found.accepted:
        return found
    surface = found.apply(model.points)
    refusal = yield from context.job(form_refusal, around, surface, settings)
    return replace(found, accepted=False, reason=refusal) if refusal else found
