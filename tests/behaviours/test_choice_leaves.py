"""Leaves that choose among the known stones, ticked in a tree to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.all_stones_placed import AllStonesPlaced
from executive.behaviours.begin_round import BeginRound
from executive.behaviours.find_course_slots import FindCourseSlots
from executive.behaviours.find_free_slots import FindFreeSlots
from executive.behaviours.no_stone_left import NoStoneLeft
from executive.behaviours.select_largest import SelectLargest
from executive.behaviours.set_aside import SetAside, SetAsideSettings
from executive.behaviours.some_stone_placed import SomeStonePlaced
from executive.behaviours.take_up_again import TakeUpAgain
from executive.errors import DataError
from executive.events.site import RoundBegun
from executive.events.stone import StoneSetAside, StonesTakenUpAgain
from executive.interfaces.objects import ObjectDatabase
from executive.messages.placement import Slot
from executive.messages.stone import StoneState

ON_GROUND, PLACED, SET_ASIDE = StoneState.ON_GROUND, StoneState.PLACED, StoneState.SET_ASIDE


@pytest.fixture
def stand(stage, database):
    return stage.Stage(objects=database)


def states(database):
    return [stone.state for stone in database.stones()]


def put(database, *wanted):
    for number, state in enumerate(wanted, 1):
        database.set_state(number, state, 2.0)


def test_a_stone_is_left_until_each_is_placed_or_set_aside(stand, database):
    ended = stand.tick(NoStoneLeft)
    assert ended.status == "FAILURE"
    assert ended.reason == "stones [1, 2] are left"
    put(database, PLACED, SET_ASIDE)
    assert stand.tick(NoStoneLeft).status == "SUCCESS"


def test_the_stone_of_most_points_is_selected(stand, database):
    ended = stand.tick(SelectLargest)
    assert ended.status == "SUCCESS"
    assert ended.outputs == {"stone": 1}
    put(database, SET_ASIDE, ON_GROUND)
    assert stand.tick(SelectLargest).outputs == {"stone": 2}


def test_nothing_is_selected_when_no_stone_lies_on_the_ground(stand, database):
    put(database, SET_ASIDE, PLACED)
    ended = stand.tick(SelectLargest)
    assert ended.status == "FAILURE"
    assert ended.reason == "no stone is left on the ground"


def test_a_slot_is_free_when_no_placed_stone_is_on_it(stand, database):
    slots = [Slot(1, np.array([5.0, 0.0, 0.0])), Slot(2, np.array([5.0, 3.0, 0.0]))]
    put(database, PLACED, ON_GROUND)
    ended = stand.tick(FindFreeSlots, slots=slots)
    assert ended.status == "SUCCESS"
    assert [slot.id for slot in ended.outputs["free_slots"]] == [2]
    put(database, PLACED, PLACED)
    ended = stand.tick(FindFreeSlots, slots=slots)
    assert ended.status == "FAILURE"
    assert ended.reason == "all 2 slots are taken"


def test_a_stone_is_set_aside_with_the_cause(stand, database):
    ended = stand.tick(SetAside, settings={"reason": "too far"}, stone=2)
    assert ended.status == "SUCCESS"
    assert states(database) == [ON_GROUND, SET_ASIDE]
    (event,) = ended.events
    assert isinstance(event, StoneSetAside)
    assert (event.stone, event.reason) == (2, "too far: no way there")


@pytest.mark.parametrize(
    ("first", "last", "told"),
    [
        ("a slip", "no way there", "too far: first, a slip; last, no way there"),
        ("no way", "no way there", "too far: no way there"),
        ("", "no way there", "too far: no way there"),
        ("", "", "too far"),
    ],
)
def test_the_first_cause_is_named_if_the_last_does_not_say_it(
    stand, monkeypatch, first, last, told
):
    monkeypatch.setattr(stand.leaf_context, "first_failure", lambda: first, raising=False)
    monkeypatch.setattr(stand.leaf_context, "last_failure", lambda: last)
    (event,) = stand.tick(SetAside, settings={"reason": "too far"}, stone=2).events
    assert event.reason == told


def test_an_unknown_stone_is_not_set_aside(stand):
    with pytest.raises(DataError, match="9"):
        stand.tick(SetAside, stone=9)


def test_a_stone_is_taken_up_again_only_after_another_was_placed(stand, database):
    put(database, ON_GROUND, SET_ASIDE)
    ended = stand.tick(TakeUpAgain)
    assert ended.status == "FAILURE"
    assert ended.reason == "no stone was set aside for a reason that may be gone"
    assert ended.events == []
    database.set_state(1, PLACED, 3.0)
    ended = stand.tick(TakeUpAgain)
    assert ended.status == "SUCCESS"
    assert states(database) == [PLACED, ON_GROUND]
    (event,) = ended.events
    assert isinstance(event, StonesTakenUpAgain)
    assert event.stones == (2,)


def test_a_round_begins_with_the_placed_stones_on_the_ground_again(stand, database):
    put(database, PLACED, SET_ASIDE)
    ended = stand.tick(BeginRound)
    assert ended.status == "SUCCESS"
    assert states(database) == [ON_GROUND, SET_ASIDE]
    (event,) = ended.events
    assert isinstance(event, RoundBegun)
    assert event.stones == (1,)


def test_a_database_that_cannot_be_written_is_no_round(stage):
    broken = stage.Scripted(ObjectDatabase, stones=DataError("the disk is full"))
    with pytest.raises(DataError, match="the disk is full"):
        stage.Stage(objects=broken).tick(BeginRound)


def test_the_mission_is_done_when_some_stone_is_placed(stand, database):
    ended = stand.tick(SomeStonePlaced)
    assert ended.status == "FAILURE"
    assert "none of 2 stones" in ended.reason
    put(database, ON_GROUND, PLACED)
    ended = stand.tick(SomeStonePlaced)
    assert ended.status == "SUCCESS"
    assert ended.reason == "1 of 2 stones placed"


def test_all_is_placed_only_when_no_known_stone_is_elsewhere(stand, database):
    put(database, PLACED, PLACED)
    ended = stand.tick(AllStonesPlaced)
    assert (ended.status, ended.reason) == ("SUCCESS", "2 of 2 stones placed")
    put(database, PLACED, SET_ASIDE)
    ended = stand.tick(AllStonesPlaced)
    assert (ended.status, ended.reason) == ("FAILURE", "1 of 2 stones placed; set aside: 2")
    put(database, ON_GROUND, StoneState.LOST)
    ended = stand.tick(AllStonesPlaced)
    assert (ended.status, ended.reason) == (
        "FAILURE",
        "0 of 2 stones placed; on ground: 1; lost: 2",
    )


def test_where_no_stone_is_known_nothing_is_placed(stage):
    empty = stage.Stage(objects=stage.Scripted(ObjectDatabase, stones=()))
    ended = empty.tick(AllStonesPlaced)
    assert (ended.status, ended.reason) == ("FAILURE", "no stone is known, so none is placed")


def test_the_reason_of_setting_aside_is_any_text_but_none():
    assert SetAsideSettings(reason="x").reason == "x"
    with pytest.raises(ValueError, match="reason"):
        SetAsideSettings(reason="")


def test_a_stone_below_a_slot_does_not_take_it(stand, database):
    put(database, PLACED, PLACED)
    low, high = np.array([5.0, 0.0, 0.0]), np.array([5.0, 0.0, 2.0])
    ended = stand.tick(FindFreeSlots, slots=[Slot(1, low), Slot(2, high)])
    assert [slot.id for slot in ended.outputs["free_slots"]] == [2]


def test_the_next_course_goes_onto_the_gaps_of_the_last(stand, database):
    ended = stand.tick(FindCourseSlots, settings={"heading": np.pi / 2}, course=[1, 2])
    assert ended.status == "SUCCESS"
    (slot,) = ended.outputs["slots"]
    first, second = (database.stone(number) for number in (1, 2))
    faces = first.points_map[:, 1].max(), second.points_map[:, 1].min()
    assert slot.position_map[1] == pytest.approx(np.mean(faces))
    tops = max(stone.points_map[:, 2].max() for stone in (first, second))
    assert slot.position_map[2] == pytest.approx(tops, abs=0.1)
    assert (slot.heading_rad, slot.gap_m) == (np.pi / 2, 0.1)


def test_one_stone_has_no_gap(stand, database):
    ended = stand.tick(FindCourseSlots, settings={"heading": 0.0}, course=[1])
    assert ended.status == "FAILURE"
    assert ended.reason == "a course of 1 stones has no gap for a stone to rest on"


def test_only_the_part_of_a_stone_beside_the_gap_carries_the_next(stand, database):
    first, second = (database.stone(number) for number in (1, 2))
    faces = first.points_map[:, 1].max(), second.points_map[:, 1].min()
    gap = np.mean(faces)
    settings = {"heading": np.pi / 2, "near": 0.2, "gap": 0.3}
    ended = stand.tick(FindCourseSlots, settings=settings, course=[2, 1])  # in any order
    (slot,) = ended.outputs["slots"]
    tops = []
    for stone in (first, second):
        away = np.abs(stone.points_map[:, 1] - gap)
        near = away < away.min() + 0.2
        tops.append(np.quantile(stone.points_map[near, 2], 0.95))
    across = np.mean([stone.box_map.centre[0] for stone in (first, second)])
    assert slot.position_map == pytest.approx([across, gap, max(tops)])
    assert (slot.id, slot.gap_m) == (1, 0.3)
    assert ended.reason == "1 slots"
