"""Events are named after their classes, and come back from what JSON holds, or are refused."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Literal

import numpy as np
import pytest

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.events.event import (
    Event,
    UnknownEvent,
    event_classes,
    event_from,
    known_kinds,
    plain,
    read_record,
)


class Side(Enum):
    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True)
class Part:
    """A part of a made-up record."""

    name: str
    size_m: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class MadeUpForATest(Event):
    """An event of every kind of field."""

    number: int
    side: Side
    place_map: Float
    parts: tuple[Part, ...]
    pair: tuple[int, str]
    counts: Mapping[str, int]
    word: Literal["a", "b"]
    told: str | None = None
    either: int | str = 0
    is_done: bool = False
    names: tuple[str, ...] = field(default_factory=tuple)


EVENT = MadeUpForATest(
    3, Side.RIGHT, np.array([1.0, 2.5]), (Part("x"), Part("y", 2.0)), (4, "z"), {"k": 5}, "a"
)
PAYLOAD = {
    "number": 3,
    "side": "right",
    "place_map": [1.0, 2.5],
    "parts": [{"name": "x", "size_m": 1.0}, {"name": "y", "size_m": 2.0}],
    "pair": [4, "z"],
    "counts": {"k": 5},
    "word": "a",
    "told": None,
    "either": 0,
    "is_done": False,
    "names": [],
}


def test_an_event_is_known_by_the_words_of_its_class() -> None:
    assert MadeUpForATest.kind == "made_up_for_a_test"
    assert "made_up_for_a_test" in known_kinds()
    assert event_classes()["MadeUpForATest"] is MadeUpForATest
    assert "UnknownEvent" not in event_classes()


def test_two_modules_may_not_define_the_same_event() -> None:
    told = "tests.events.test_event and elsewhere both define the event 'made_up_for_a_test'"
    with pytest.raises(ConfigError, match=told):
        type("MadeUpForATest", (Event,), {"__module__": "elsewhere"})


def test_an_event_comes_back_from_its_payload() -> None:
    assert EVENT.payload() == PAYLOAD
    again = event_from("made_up_for_a_test", json.loads(json.dumps(EVENT.payload())))
    assert isinstance(again, MadeUpForATest)
    assert again.payload() == PAYLOAD
    assert (again.side, again.parts, again.pair) == (Side.RIGHT, EVENT.parts, (4, "z"))
    assert again.place_map.dtype == np.float64


def test_an_event_of_no_imported_package_stays_as_it_is() -> None:
    found = event_from("nobody_knows_it", {"a": [1]})
    assert isinstance(found, UnknownEvent)
    assert (found.name, found.payload()) == ("nobody_knows_it", {"a": [1]})
    assert found.payload() is not found.values


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"number": "3"}, "field 'number': expected"),
        ({"number": 3.5}, "field 'number': expected"),
        ({"number": True}, "field 'number': expected"),
        ({"side": "up"}, "field 'side': expected one of left, right, got 'up'"),
        ({"place_map": "x"}, "field 'place_map': expected an array of numbers, got 'x'"),
        ({"place_map": [[1], [1, 2]]}, "field 'place_map': expected an array of numbers"),
        ({"parts": {}}, "field 'parts': expected a list, got {}"),
        ({"parts": [{"name": "x"}, 4]}, "field 'parts'[1]: expected a mapping, got 4"),
        ({"parts": [{}]}, "field 'parts'[0] lacks its field 'name'"),
        ({"parts": [{"name": "x", "sise": 1}]}, "field 'parts'[0] has no field 'sise'"),
        ({"pair": [4]}, "field 'pair': expected a list of 2, got [4]"),
        ({"pair": ["z", 4]}, "field 'pair'[0]: expected"),
        ({"counts": [5]}, "field 'counts': expected"),
        ({"word": "c"}, "field 'word': expected one of a, b, got 'c'"),
        ({"told": 5}, "field 'told': expected"),
        ({"either": None}, "field 'either': expected"),
        ({"is_done": 1}, "field 'is_done': expected"),
        ({"more": 1}, " has no field 'more'"),
        ({"word": "c" * 90}, f"got '{'c' * 79} …"),
    ],
)
def test_a_field_of_another_form_is_refused_by_its_name(change: Any, told: str) -> None:
    with pytest.raises(DataError) as caught:
        event_from("made_up_for_a_test", {**PAYLOAD, **change})
    assert told in str(caught.value)


@pytest.mark.parametrize("name", ["number", "side", "place_map", "parts", "pair", "counts", "word"])
def test_a_field_without_a_default_may_not_be_missing(name: str) -> None:
    payload = {key: value for key, value in PAYLOAD.items() if key != name}
    with pytest.raises(DataError, match=f"lacks its field '{name}'"):
        event_from("made_up_for_a_test", payload)


def test_fields_with_defaults_may_be_missing_and_either_type_is_read() -> None:
    needed = {key: PAYLOAD[key] for key in list(PAYLOAD)[:7]}
    assert event_from("made_up_for_a_test", needed).payload() == PAYLOAD
    again = event_from("made_up_for_a_test", {**needed, "either": "x", "told": "y"})
    assert isinstance(again, MadeUpForATest)
    assert (again.either, again.told) == ("x", "y")


def test_a_record_that_is_no_mapping_is_refused() -> None:
    with pytest.raises(DataError, match=r"a part: expected a mapping, got \[\]"):
        read_record(Part, [], "a part")


class Odd:
    def __str__(self) -> str:
        return "odd"


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (Side.LEFT, "left"),
        (np.float32(0.5), 0.5),
        (np.array([[1, 2]]), [[1, 2]]),
        ({3: Side.LEFT}, {"3": "left"}),
        ((1, [2, (3,)]), [1, [2, [3]]]),
        (Part("x"), {"name": "x", "size_m": 1.0}),
        (None, None),
        (True, True),
        (Odd(), "odd"),
    ],
)
def test_values_become_what_json_holds(value: object, told: object) -> None:
    found = plain(value)
    assert found == told
    assert type(found) is type(told)
