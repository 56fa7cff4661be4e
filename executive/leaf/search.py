"""Search the map for a stone: the step that the leaves which look for stones share."""

import numpy as np
from pydantic import Field

from executive.config import Meters
from executive.events.stone import StoneLost, StoneSoughtAgain
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Steps
from executive.leaf.context import Context
from executive.leaf.fitting import registered
from executive.leaf.form_evidence import FormSettings
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import map_cloud, unexplained
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState

_NEAR_M = 0.10  # a map point this near to a stone's model is of that stone
_SHOWN = 0.4  # share of a model's points that a look at the stone shows, as in an alignment's gate
_SAME_PLACE_M = 0.6  # a segment this near to a stone that is done is that stone


class SearchSettings(FormSettings):
    radius: Meters = Field(
        4.0, gt=0, le=20, description="Distance from its last known place that is searched [m]."
    )


def search(context: Context, stone_id: int, settings: SearchSettings) -> Steps[None]:
    """Look for a stone in the newest map, and update the database; one that is gone is lost.

    The stone's whole model is registered first, in any orientation and beside whatever it leans
    on, so that model and rotation are kept. If registration refuses, the map is segmented, and the
    segment that is found there may replace the model. What neither finds is still where it was if
    the map shows it there. One that the map does not show there may be as far as it can roll: what
    lies there, and is no other known stone, is it, and no new one.

    Args:
        context: The leaf's view of the mission; it needs mapping, segmentation, registration and
            objects.
        stone_id: Id of the stone.
        settings: How far to search horizontally, and how likely the form has to be.
    """
    objects, radius_m = context.use(ObjectDatabase), settings.radius
    known = objects.stone(stone_id)
    near = (yield from map_cloud(context)).near(known.centroid_map, radius_m)
    if not len(near):
        return failed(f"the map shows nothing around stone {stone_id}")
    around = yield from unexplained(context, stone_id, radius_m)
    model = Cloud("map", known.points_map)
    found = yield from registered(context, around, model, settings)
    if found.accepted:
        note = f"registration, {found.reason}"
        objects.realign(stone_id, found.T_target_source, context.now_s(), note)
        if known.state is StoneState.LOST:
            objects.set_state(stone_id, StoneState.ON_GROUND, context.now_s())
        context.record(StoneSoughtAgain(stone_id, (stone_id,), "registration", note))
        return succeeded(reason=note)
    is_shown = yield from context.job(_is_shown, known, around)
    if not is_shown and known.state is not StoneState.LOST:
        objects.set_state(stone_id, StoneState.LOST, context.now_s())
    segmentation = yield from context.job(context.use(Segmenter).segment, near)
    others = [one.with_foot() for one in _sought(segmentation, context, stone_id)]
    seen = yield from context.job(objects.observe, others, context.now_s(), False)
    ids = tuple(one.id for one in seen)
    context.record(StoneSoughtAgain(stone_id, ids, "segmentation", found.reason))
    if stone_id in ids or is_shown:
        return succeeded()
    reason = f"stone {stone_id} was not found within {radius_m:.1f} m of its last place"
    if known.state is not StoneState.LOST:
        context.record(StoneLost(stone_id, reason))
    return failed(reason)


def _is_shown(stone: Stone, around: Cloud) -> bool:
    """Return whether the map shows a stone that is not lost where it was.

    The lowest part of its model does not count: the ground alone would show it.
    """
    low_m = stone.points_map[:, 2].min() + 2 * _NEAR_M
    upper = stone.points_map[stone.points_map[:, 2] > low_m]
    if stone.state is StoneState.LOST or not len(around) or not len(upper):
        return False
    from scipy.spatial import cKDTree  # reading a mission imports no algorithm

    reached = cKDTree(around.points).query(upper, distance_upper_bound=_NEAR_M)[0]
    return bool(np.isfinite(reached).mean() >= _SHOWN)


def _sought(segmentation: Segmentation, context: Context, stone_id: int) -> list[Segment]:
    """Leave out segments of other stones that are in their slots, and those beyond the reach.

    Nobody looks for the former. Of the latter the lidars see the near side alone, which would be
    entered as a stone, and not be known again once the machine has driven there.
    """
    base_m, reach_m = context.state().T_map_base[:2, 3], context.machine().reach_m
    done = (StoneState.PLACED, StoneState.SET_ASIDE)
    places = [
        stone.centroid_map[:2]
        for stone in context.use(ObjectDatabase).stones()
        if stone.state in done and stone.id != stone_id
    ]
    return [
        segment
        for segment in segmentation.segments
        if np.hypot(*(segment.centroid[:2] - base_m)) <= reach_m
        and all(np.hypot(*(segment.centroid[:2] - place)) > _SAME_PLACE_M for place in places)
    ]
