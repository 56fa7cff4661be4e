"""Leaves that tell what a mission found, ticked in a tree to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.count_stones import CountStones
from executive.behaviours.list_stones import ListStones
from executive.behaviours.mark_point import MarkPoint
from executive.behaviours.mark_region import MarkRegion
from executive.behaviours.mark_stone import MarkStone
from executive.behaviours.report_figure import ReportFigure
from executive.events.finding import FigureReported, Marked, StonesListed
from executive.interfaces.objects import ObjectDatabase
from executive.messages.region import Region
from executive.messages.stone import StoneState


def test_a_point_is_marked_recorded_and_shown(stage) -> None:
    ended = stage.Stage().tick(MarkPoint, settings={"text": "soft ground", "at": (5.0, 2.0, 0.1)})
    assert (ended.status, ended.reason) == ("SUCCESS", "soft ground")
    (event,) = ended.events
    assert isinstance(event, Marked)
    assert (event.text, event.kind_of_place, event.stone) == ("soft ground", "point", None)
    np.testing.assert_array_equal(event.position_map, [5.0, 2.0, 0.1])
    shown = ended.shown["marks/soft_ground"]
    assert shown.text == "soft ground"
    np.testing.assert_array_equal(shown.position_map, [5.0, 2.0, 0.1])


def test_without_a_point_the_gripper_marks_where_it_is(stage) -> None:
    ended = stage.Stage().tick(MarkPoint, settings={"text": "here"})
    np.testing.assert_array_equal(ended.events[0].position_map, [5.0, 0.0, 2.0])


def test_a_gripper_whose_place_is_not_known_marks_nothing(stage) -> None:
    stand = stage.Stage()
    stand.leaf_context.gripper = lambda: np.full((4, 4), np.nan)
    ended = stand.tick(MarkPoint, settings={"text": "here"})
    assert ended.status == "FAILURE"
    assert ended.reason == "no point to mark with 'here': its coordinates are not finite"
    assert (ended.events, ended.shown) == ([], {})


def test_a_stone_is_marked_at_its_centroid(stage, database) -> None:
    ended = stage.Stage(objects=database).tick(MarkStone, settings={"text": "cracked"}, stone=2)
    assert (ended.status, ended.reason) == ("SUCCESS", "stone 2: cracked")
    (event,) = ended.events
    assert (event.kind_of_place, event.stone) == ("stone", 2)
    np.testing.assert_allclose(event.position_map, database.stone(2).centroid_map)
    assert ended.shown["marks/stone_2"].text == "cracked"


def test_a_region_is_marked_at_the_height_that_the_map_shows_there(stage) -> None:
    stand = stage.Stage(mapping=stage.PointMap([[1.0, 1.0, 0.4], [1.5, 1.0, 0.6], [9.0, 9.0, 5.0]]))
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    stand.leaf_context.regions["yard"] = Region("yard", corners)
    ended = stand.tick(MarkRegion, settings={"region": "yard", "text": "clear"})
    assert (ended.status, ended.reason) == ("SUCCESS", "yard: clear")
    (event,) = ended.events
    assert (event.kind_of_place, event.region) == ("region", "yard")
    np.testing.assert_allclose(event.position_map, [1.0, 1.0, 0.5])
    assert ended.shown["marks/yard"].text == "clear"


def test_a_region_that_was_not_seen_is_not_marked(stage) -> None:
    stand = stage.Stage(mapping=stage.PointMap([[9.0, 9.0, 5.0]]))
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    stand.leaf_context.regions["yard"] = Region("yard", corners)
    ended = stand.tick(MarkRegion, settings={"region": "yard", "text": "clear"})
    assert ended.status == "FAILURE"
    assert ended.reason == "the map shows nothing of the region 'yard': scan it first"
    assert (ended.events, ended.shown) == ([], {})


def test_stones_are_counted_by_their_size(stage, database) -> None:
    ended = stage.Stage(objects=database).tick(CountStones, settings={"min_volume": "10 m3"})
    assert ended.outputs == {"count": 0}


def test_an_unknown_stone_is_not_marked(stage, database) -> None:
    ended = stage.Stage(objects=database).tick(MarkStone, settings={"text": "cracked"}, stone=9)
    assert ended.status == "FAILURE"
    assert "9" in ended.reason
    assert (ended.events, ended.shown) == ([], {})


def test_stones_are_counted_by_their_state(stage, database) -> None:
    database.set_state(2, StoneState.LOST, 2.0)
    stand = stage.Stage(objects=database)
    lying = stand.tick(CountStones)
    lost = stand.tick(CountStones, settings={"states": (StoneState.LOST,)})
    assert (lying.status, lying.outputs) == ("SUCCESS", {"count": 1})
    assert (lost.status, lost.outputs) == ("SUCCESS", {"count": 1})


def test_too_few_stones_are_a_failure_that_writes_the_count(stage, database) -> None:
    ended = stage.Stage(objects=database).tick(CountStones, settings={"at_least": 3})
    assert (ended.status, ended.reason) == ("FAILURE", "2 stones, and 3 are wanted")
    assert ended.outputs == {"count": 2}


def test_all_stones_are_listed_with_place_and_extents(stage, database) -> None:
    ended = stage.Stage(objects=database).tick(ListStones)
    assert (ended.status, ended.reason) == ("SUCCESS", "2 stones")
    (event,) = ended.events
    assert isinstance(event, StonesListed)
    assert [(stone.id, stone.state) for stone in event.stones] == [
        (1, "on_ground"),
        (2, "on_ground"),
    ]
    np.testing.assert_allclose(event.stones[0].centroid_map, [5.0, 0.0, 0.3], atol=0.05)
    np.testing.assert_allclose(event.stones[0].extents_m, [1.0, 0.8, 0.6], atol=0.02)
    assert event.stones[0].volume_m3 == pytest.approx(0.48, abs=0.05)


def test_a_list_without_stones_is_a_failure_that_is_recorded(stage) -> None:
    empty = stage.Scripted(ObjectDatabase, stones=())
    ended = stage.Stage(objects=empty).tick(ListStones)
    assert (ended.status, ended.reason) == ("FAILURE", "no stone is known")
    assert [event.stones for event in ended.events] == [()]


def test_a_figure_is_reported_with_its_unit(stage) -> None:
    settings = {"name": "volume_seen", "value": 2.5, "unit": "m3"}
    ended = stage.Stage().tick(ReportFigure, settings=settings)
    assert (ended.status, ended.reason) == ("SUCCESS", "volume_seen = 2.5 m3")
    (event,) = ended.events
    assert isinstance(event, FigureReported)
    assert (event.name, event.value, event.unit) == ("volume_seen", 2.5, "m3")


@pytest.mark.parametrize("wrong", [{"name": "two words"}, {"value": float("nan")}, {"value": "x"}])
def test_a_figure_without_a_usable_name_or_number_is_refused(wrong) -> None:
    with pytest.raises(ValueError, match="validation error"):
        ReportFigure.Settings(**({"name": "count", "value": 1.0} | wrong))
