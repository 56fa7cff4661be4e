"""What a mission found, from its journal: of what is told twice, the newest counts."""

from typing import Any

import numpy as np

from executive.events.finding import FigureReported, ListedStone, MapSaved, Marked, StonesListed
from executive.events.site import BuildingEnded
from executive.journal.entry import Entry
from executive.mission.record.findings import Findings


def found(*events: Any) -> Findings:
    made = Findings()
    for number, event in enumerate(events):
        made.add(Entry(number, number, 0.5 * number, "main", event))
    return made


def listed(number: int) -> StonesListed:
    stone = ListedStone(number, "on_ground", np.zeros(3), np.ones(3), 50, None)
    return StonesListed((stone,))


def test_nothing_is_found_before_it_is_told() -> None:
    nothing = found()
    assert (nothing.figures, nothing.marks, nothing.stones) == ({}, (), ())
    assert (nothing.maps, nothing.structures) == ((), ())


def test_the_newest_figure_of_a_name_and_the_newest_list_of_stones_count() -> None:
    told = found(
        FigureReported("depth", 1.5, "m"),
        FigureReported("share", 0.2, ""),
        listed(1),
        FigureReported("depth", 2.5, "m"),
        listed(7),
    )
    figures = {name: (one.value, one.unit) for name, one in told.figures.items()}
    assert figures == {"depth": (2.5, "m"), "share": (0.2, "")}
    assert [one.id for one in told.stones] == [7]


def test_marks_are_kept_in_order_with_their_times() -> None:
    place = np.array([1.0, 2.0, 3.0])
    told = found(
        Marked("here", "point", place),
        Marked("it", "stone", place, 4),
        Marked("yard", "region", place, None, "y"),
    )
    assert [(one.time_s, one.text, one.kind_of_place) for one in told.marks] == [
        (0.0, "here", "point"),
        (0.5, "it", "stone"),
        (1.0, "yard", "region"),
    ]
    assert [one.stone for one in told.marks] == [None, 4, None]
    assert [one.region for one in told.marks] == ["", "", "y"]
    assert np.array_equal(told.marks[0].position_map, place)


def test_the_newest_map_of_a_file_and_the_newest_end_of_a_structure_count() -> None:
    maps = [MapSaved(name, n, "map", np.eye(4)) for n, name in enumerate(("a", "b", "a"))]
    ends = [BuildingEnded("wall", why, "", (1,), {}) for why in ("no_stones", "complete")]
    told = found(*maps, *ends)
    assert told.maps == (maps[2], maps[1])
    assert told.structures == (ends[1],)
