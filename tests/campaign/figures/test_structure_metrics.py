"""Each metric of structures on runs that are made up, with the value that its definition gives."""

import math
from dataclasses import fields
from typing import Any

import pytest

from executive import registry
from executive.events.event import Event
from executive.events.site import BuildingEnded, BuildingPlanned
from executive.events.stone import PlacementVerified, StoneRealigned, StoneReleased
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.metric import RunRecord, Share, TimedEvent, Values
from executive.interfaces.report import MissionReport, Timing
from executive.interfaces.truth import TrueStone, TrueStructure, Truth
from executive.testing.blank import blank

METRICS = "metric"
PLAN = pose(from_rpy(0.0, 0.0, 0.5), [2.0, 5.0, 0.4])


def measured(name: str, events: list[Event], **report: Any) -> Any:
    timed = [TimedEvent(float(n), event) for n, event in enumerate(events)]
    made_up = blank(MissionReport, **{"timings_ms": {}, "picks": (), **report})
    return registry.load(METRICS, name)().measure(RunRecord(made_up, timed))


def made(kind: type[Event], **values: Any) -> Event:
    return kind(**{**{one.name: 0.0 for one in fields(kind)}, **values})


def planned(stone: int, *standing: int) -> Event:
    return made(BuildingPlanned, structure="wall", stone=stone, standing=standing)


def released(stone: int) -> Event:
    return made(StoneReleased, stone=stone, planned_pose=PLAN)


def realigned(stone: int, yaw_rad: float, *, accepted: bool = True) -> Event:
    T = pose(from_rpy(0.0, 0.0, 0.5 + yaw_rad), PLAN[:3, 3])
    return made(StoneRealigned, stone=stone, accepted=accepted, estimated_pose=T)


def seen(
    stone: int, off_m: float | None, tilt_rad: float | None = 0.0, *, turn_known: bool = True
) -> Event:
    how = "unseen" if off_m is None else "placed"
    looked = {"off_m": off_m, "tilt_rad": tilt_rad, "turn_known": turn_known}
    return made(PlacementVerified, stone=stone, seen=how, **looked)


def ended(reason: str, *standing: int) -> Event:
    return made(BuildingEnded, structure="wall", reason=reason, standing=standing)


def laid(stone: int, off_m: float, yaw_rad: float) -> list[Event]:
    return [planned(stone), released(stone), realigned(stone, yaw_rad), seen(stone, off_m)]


@pytest.mark.parametrize(
    ("off_m", "yaw_rad", "hits"),
    [(0.099, 0.0, 1), (0.101, 0.0, 0), (0.0, math.radians(9.9), 1), (0.0, math.radians(10.1), 0)],
)
def test_a_stone_is_as_planned_within_10_cm_and_10_degrees(
    off_m: float, yaw_rad: float, hits: int
) -> None:
    assert measured("built_as_planned", laid(1, off_m, yaw_rad)) == Share(hits, 1)


def test_each_release_on_a_structure_counts_and_others_do_not() -> None:
    events = [*laid(1, 0.2, 0.1), *laid(1, 0.04, 0.02), released(7), seen(7, 0.01)]
    assert measured("built_as_planned", events) == Share(1, 2)
    assert measured("built_error_m", events) == Values((0.2, 0.04))
    assert measured("built_error_rad", events).values == pytest.approx((0.1, 0.02))


def test_a_stone_that_is_not_seen_again_is_not_as_planned() -> None:
    events = [planned(1), released(1), seen(1, None, None), planned(2), released(2)]
    assert measured("built_as_planned", events) == Share(0, 2)
    assert measured("built_error_m", events) == Values(())
    assert measured("built_error_rad", events) == Values(())


@pytest.mark.parametrize(
    "look",
    [[], [realigned(1, 0.5, accepted=False)], [realigned(1, 0.5)]],
    ids=["another way", "refused", "turn unknown"],
)
def test_without_an_aligned_model_the_tilt_alone_is_known(look: list[Event]) -> None:
    aligned = any(one.accepted for one in look if isinstance(one, StoneRealigned))
    events = [planned(1), released(1), *look, seen(1, 0.05, 0.03, turn_known=not aligned)]
    assert measured("built_error_rad", events) == Values((0.03,))


def test_a_look_long_after_the_release_does_not_change_what_was_seen_then() -> None:
    events = [*laid(1, 0.04, 0.02), realigned(1, 0.7), seen(1, 0.9)]
    assert measured("built_error_m", events) == Values((0.04,))
    assert measured("built_error_rad", events).values == pytest.approx((0.02,))


def test_stones_stand_by_the_newest_plan_and_by_what_was_placed_after_it() -> None:
    events = [*laid(1, 0.02, 0.0), *laid(2, 0.02, 0.0), planned(3, 1, 7), released(3)]
    assert measured("stones_built", events) == Values((2,))  # the mission lost stone 2
    assert measured("stones_built", [*events, seen(3, 0.02)]) == Values((3,))
    assert measured("stones_built", [*events, seen(3, None, None)]) == Values((2,))
    assert measured("stones_built", [*events, seen(3, 0.02), ended("complete", 3)]) == Values((1,))


def test_of_the_stones_that_stand_the_true_error_counts() -> None:
    errors = {1: 0.02, 2: 0.5, 3: None, 7: 0.6}
    true = tuple(
        blank(TrueStone, id=10 + stone, held_object=stone, database_error_m=error)
        for stone, error in errors.items()
    )
    events = [planned(2, 1, 3)]
    truth = blank(Truth, stones=true)
    assert measured("standing_error_m", events, truth=truth) == Values((0.02,))
    assert measured("standing_error_m", events, truth=None) is None


def test_a_structure_without_a_stone_has_none() -> None:
    assert measured("stones_built", [ended("nothing_fits")]) == Values((0,))
    assert measured("stones_built", [planned(1)]) == Values((0,))


@pytest.mark.parametrize(
    ("events", "hits"),
    [
        ([ended("complete")], 1),
        ([planned(1), ended("nothing_fits")], 1),
        ([planned(1), ended("all_too_heavy")], 1),
        ([planned(1), ended("stale_map")], 0),
        ([planned(1), ended("out_of_time")], 0),
        ([planned(1)], 0),
        ([planned(1), ended("nothing_fits"), planned(2)], 0),
    ],
)
def test_a_structure_ends_when_no_stone_can_be_added(events: list[Event], hits: int) -> None:
    assert measured("structure_ended", events) == Share(hits, 1)


def test_the_planners_time_is_in_seconds() -> None:
    timings = {"building.propose": Timing(4000.0, 15500.0, 17)}
    assert measured("building_time", [], timings_ms=timings) == Values((4.0,))
    assert measured("building_time_p95", [], timings_ms=timings) == Values((15.5,))


def test_a_mission_that_builds_nothing_has_no_value() -> None:
    homes = {
        name: type(registry.load(METRICS, name)()).__module__ for name in registry.names(METRICS)
    }
    names = [name for name, home in homes.items() if home.endswith(".structures")]
    assert len(names) == 8
    assert {measured(name, [released(1), seen(1, 0.0)]) for name in names} == {None}


VERDICT = {
    "fill": 0.4, "running_joints": 0.25, "drift_20s_m": 0.01, "pushed_m": 0.02,
    "tilt_across_deg": 10.0, "tilt_along_deg": 15.0, "tilt_across_slippery_deg": 5.0,
}  # fmt: skip
JUDGED = {
    "standing_fill": 0.4,
    "standing_joints": 0.25,
    "standing_drift_m": 0.01,
    "standing_pushed_m": 0.02,
    "standing_tilt_across_rad": math.radians(10.0),
    "standing_tilt_along_rad": math.radians(15.0),
    "standing_tilt_slippery_rad": math.radians(5.0),
}


def truly(*structures: TrueStructure) -> Truth:
    return blank(Truth, structures=structures)


@pytest.mark.parametrize("name", JUDGED)
def test_a_judges_figure_is_told_of_each_structure_that_has_one(name: str) -> None:
    judged = TrueStructure("wall", (1, 2), (), (), VERDICT)
    open_ended = TrueStructure("row", (3,), (), (), dict.fromkeys(VERDICT))
    empty = TrueStructure("cairn", (), (), ())
    found = measured(name, [], truth=truly(judged, open_ended, empty))
    assert found == Values((pytest.approx(JUDGED[name]),))
    assert measured(name, [], truth=truly(open_ended)) == Values(())
    for truth in (None, truly(), truly(empty)):
        assert measured(name, [], truth=truth) is None


def test_what_stands_and_what_has_moved_is_told_by_the_truth() -> None:
    truth = truly(TrueStructure("wall", (1, 2), (), (0.01, 0.3)), TrueStructure("row", (), (), ()))
    assert measured("stones_standing", [], truth=truth) == Values((2.0, 0.0))
    assert measured("standing_moved_m", [], truth=truth) == Values((0.01, 0.3))
    for none in (None, truly()):
        assert measured("stones_standing", [], truth=none) is None
        assert measured("standing_moved_m", [], truth=none) is None
