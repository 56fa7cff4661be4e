"""Find the stones in the map and enter them into the database."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.events.site import PartLeftOut, SiteSegmented, SurveyFitted
from executive.geometry.local_shift import local_shift
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import map_cloud
from executive.messages.cloud import Cloud
from executive.messages.moving_places import MovingPlaces
from executive.messages.segment import PartKind, Segmentation
from executive.messages.stone import Stone

_MOST_MOVING = 0.5  # share of a part's points in places of which the map says that they do
_BEYOND_REACH_M = 1.0  # of the survey is kept, for stones at the border of the reach


@dataclass(frozen=True, slots=True)
class SiteSegments:
    """The site's ground and stones.

    Attributes:
        segmentation: Ground and objects of the merged map.
        stones: The stones as they were seen, in the order of the segments.
    """

    segmentation: Segmentation
    stones: list[Stone]


class SegmentMapSettings(Settings):
    at_least: int = Field(
        1, ge=0, le=1000, description="Fewer stones than this in the map are a failure."
    )
    max_distance: Meters | None = Field(
        None,
        gt=0,
        le=100,
        description="Distance of a stone's centroid from the chassis from which on it is left out "
        "[m]; none is if not given.",
    )
    survey_std: Meters = Field(
        0.04,
        ge=0,
        le=0.5,
        description="Standard deviation, along each axis, of how far the registered survey lies "
        "off the map: by what the registration leaves, and by the survey's own warp [m]. 0 merges "
        "it as it is registered.",
    )
    survey_patch: Meters = Field(
        0.75,
        gt=0.1,
        le=10,
        description="Over such a distance the survey is shifted alike [m]: half of a stone.",
    )


class SegmentMap(Action[SegmentMapSettings]):
    """Segment the map, merged with the drone's map where there is one.

    Source: Mascaro et al. 2020, Sec. 4.3 and Sec. 4.4, step 6. Deviation from the paper, which
    merges matched segments pair by pair: segmenting the merged map gives the same models and also
    those stones that only one of the two maps shows. Before, the survey is laid onto the map from
    place to place, see `local_shift`: a stone that both show would have two surfaces otherwise.
    A stone's model includes its foot, where the jaws close.

    What the mapper has seen to move, a person or a stone that rolls, is told as moving, and is no
    stone. Stones beyond `max_distance` are told as far: the lidars see their near side alone, which
    from near by may not be known again.
    """

    needs = (Mapper, Segmenter, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, drone_map: Cloud | None = None) -> Steps[SiteSegments]:
        """Segment, and match the segments with known stones.

        Args:
            drone_map: The drone's map expressed in the frame `map`.
        """
        segmenter, clouds = self.context.use(Segmenter), [(yield from map_cloud(self.context))]
        moving = self.context.use(Mapper).moving()
        if drone_map is not None:
            clouds.append((yield from self._fitted(self._in_reach(drone_map), clouds[0])))
        merged = yield from self.context.job(segmenter.merge, clouds)
        if not len(merged):
            return failed("the map is empty: scan first")
        segmentation = yield from self.context.job(segmenter.segment, merged)
        segmentation = segmentation.leaving_out(PartKind.MOVING, partial(_moves, moving))
        if self.settings.max_distance is not None:
            segmentation = segmentation.leaving_out(PartKind.FAR, self._is_far)
        stones = yield from self.context.job(
            self.context.use(ObjectDatabase).observe,
            [segment.with_foot() for segment in segmentation.segments],
            self.context.now_s(),
            drone_map is not None,
        )
        self.context.record(_event(segmentation, stones))
        self.context.show("segments", segmentation)
        for stone in stones:
            self.context.show(f"stones/{stone.id}", stone)
        if len(stones) < self.settings.at_least:
            found = f"{len(stones)} stones were" if stones else "no stone was"
            return failed(f"{found} found on the site")
        return succeeded(SiteSegments(segmentation, list(stones)), f"{len(stones)} stones")

    def _fitted(self, survey: Cloud, lidar_map: Cloud) -> Generator[Any, Any, Cloud]:
        """Return the survey, shifted onto the map."""
        s = self.settings
        if not (s.survey_std and len(survey)):
            return survey
        shifts, told = yield from self.context.job(
            _shifts, survey.points, lidar_map.points, s.survey_std, s.survey_patch
        )
        self.context.record(told)
        return Cloud(survey.frame, survey.points + shifts, survey.normals)

    def _in_reach(self, drone_map: Cloud) -> Cloud:
        """Return the part of the survey that the arm can reach and the lidar map can confirm."""
        base = self.context.state().T_map_base[:2, 3]
        return drone_map.near(base, self.context.machine().reach_m + _BEYOND_REACH_M)

    def _is_far(self, points_map: Float) -> str:
        """Say how far a part is; empty if stones are looked for there."""
        base = self.context.state().T_map_base[:2, 3]
        away_m = float(np.linalg.norm(points_map.mean(axis=0)[:2] - base))
        most_m = self.settings.max_distance
        if most_m is None or away_m <= most_m:
            return ""
        return f"{away_m:.1f} m away, and stones are looked for up to {most_m:g} m"


def _moves(places: MovingPlaces, points_map: Float) -> str:
    """Say why a part moves; empty if it stands."""
    share = places.share(points_map)
    return (
        f"{share:.0%} of its points are where nothing was a moment ago, or are seen through"
        if share > _MOST_MOVING
        else ""
    )


def _shifts(
    survey: Float, reference: Float, std_m: float, width_m: float
) -> tuple[Float, SurveyFitted]:
    """Return the shifts of a survey's points onto a map [m], shape (N, 3), and what they are."""
    found = local_shift(survey, reference, std_m, width_m)
    shifts = found.at(survey)
    lengths_m = np.linalg.norm(shifts, axis=1)
    return shifts, SurveyFitted(found.share, float(np.median(lengths_m)), float(lengths_m.max()))


def _event(segmentation: Segmentation, stones: Sequence[Stone]) -> SiteSegmented:
    return SiteSegmented(
        stones=tuple(stone.id for stone in stones),
        points=tuple(len(stone.points_map) for stone in stones),
        left_out=tuple(
            PartLeftOut(str(one.kind), one.reason, one.points, one.centroid)
            for one in segmentation.left_out
        ),
        scattered_points=segmentation.scattered_points,
        warnings=segmentation.warnings,
    )
