"""Releases of stones that did not stay where they were let go, by the database's own history."""

from collections.abc import Mapping, Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry.polygon import area_m2, contains, distance_to_outline, outline_of
from executive.geometry.pose import inverse
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.sightings import SIGHTINGS
from executive.messages.building import FailedRelease, StandingStone
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent

_STAYED_M = 0.3  # a stone that was seen no farther from its release stayed there (VerifyPlacement)
_LIES = (StoneState.ON_GROUND, StoneState.SET_ASIDE)


def failed_releases(
    stones: Sequence[Stone],
    standing: Mapping[int, StandingStone],
    solids: Mapping[int, StandingStone],
    objects: ObjectDatabase,
) -> tuple[FailedRelease, ...]:
    """Return the releases that failed on stones which stand as they did then, oldest first.

    A stone that was seen farther off than 0.3 m, or that is lost since, did not stay. A release is
    left out if one of the stones that were below it is no longer there, as that may have been what
    gave way; and one onto the ground alone: the ground bears any stone, and what failed was the
    stone.

    Args:
        stones: All stones.
        standing: Stones that stand and are known by their own models, by id.
        solids: Solids of all stones, by id.
        objects: The database.
    """
    found = []
    history = {one.id: objects.history(one.id) for one in stones}
    for stone in stones:
        for release in _failed(history[stone.id], stone.id in standing):
            below = {
                n: one
                for n, one in solids.items()
                if n != stone.id
                and (then := _as_it_stood(one, history[n], release.stamp_s)) is not None
                and _is_below(then, release.T_map_object[:3, 3], solids[stone.id])
            }
            stand_still = all(
                n in standing and _begun_s(history[n]) < release.stamp_s for n in below
            )
            if below and stand_still:
                names = frozenset(one.stone.name for one in below.values())
                radius_m = float(np.sqrt(area_m2(_outline(solids[stone.id])) / np.pi))
                at = release.T_map_object[:2, 3]
                found.append((release.stamp_s, FailedRelease(at, radius_m, names)))
    return tuple(one for _, one in sorted(found, key=lambda pair: pair[0]))


def _as_it_stood(
    one: StandingStone, history: Sequence[StoneEvent], stamp_s: float
) -> StandingStone | None:
    """Return a stone where it was placed at a time; None if it was not placed then."""
    before = [event for event in history if event.stamp_s < stamp_s]
    if not before or before[-1].state is not StoneState.PLACED:
        return None
    T_then_now = before[-1].T_map_object @ inverse(history[-1].T_map_object)
    return StandingStone(one.stone, T_then_now @ one.T_map_stone)


def _failed(history: Sequence[StoneEvent], is_standing: bool) -> list[StoneEvent]:
    """Return the releases at a place after which a stone was seen elsewhere, or not again."""
    failed: list[StoneEvent] = []
    open_one: StoneEvent | None = None
    for event in history:
        if event.kind == "release":
            open_one = event if event.state is StoneState.PLACED else None
        elif open_one is None:
            continue
        elif event.kind == "grasp" or (event.kind in SIGHTINGS and _is_near(event, open_one)):
            open_one = None
        elif event.state in _LIES:
            failed.append(open_one)
            open_one = None
    if open_one is not None and not is_standing and history[-1].state is StoneState.LOST:
        failed.append(open_one)
    return failed


def _is_near(event: StoneEvent, release: StoneEvent) -> bool:
    away = event.T_map_object[:3, 3] - release.T_map_object[:3, 3]
    return bool(np.linalg.norm(away) <= _STAYED_M)


def _begun_s(history: Sequence[StoneEvent]) -> float:
    """Return since when a stone is where it stands, but for what it was pushed [s]."""
    released = [event.stamp_s for event in history if event.kind == "release"]
    return released[-1] if released else history[0].stamp_s


def _is_below(one: StandingStone, at_map: Float, stone: StandingStone) -> bool:
    """Return whether a stone reaches below another one that is let go at a point."""
    corners, at = _outline(one), at_map[None, :2]
    reach_m = float(np.linalg.norm(stone.stone.vertices[:, :2], axis=1).max())
    is_lower = one.T_map_stone[2, 3] < at_map[2]
    is_over = bool(contains(corners, at)[0]) or distance_to_outline(corners, at)[0] < reach_m
    return bool(is_lower and is_over)


def _outline(one: StandingStone) -> Float:
    return outline_of(one.vertices_map()[:, :2])
