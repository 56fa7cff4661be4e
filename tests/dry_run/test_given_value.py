"""A mock's file gives values by the types of the ports; a value of another type is told."""

import typing
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, Literal

import numpy as np
import pytest

from executive.dry_run.given_value import read_given
from executive.dry_run.made_up import Maker
from executive.tree.catalogue import TableCatalogue
from executive.tree.document import read_file
from executive.tree.expressions.dimension import NAMED
from executive.tree.problem import Problems
from executive.tree.reading import Reading

Metres = Annotated[float, NAMED["length"]]


class Colour(StrEnum):
    GREY = "grey"
    RED = "red"


@dataclass(frozen=True)
class Stone:
    """A stone.

    Attributes:
        id: Its number.
        size: Its length [m].
        colours: Its colours.
        place: Where it lies [m], shape (3,).
    """

    id: int
    size: Metres
    colours: list[Colour]
    place: np.ndarray


@pytest.fixture
def given(tmp_path):
    """Return the value that a file's text gives for a type, and what is told instead."""

    def given(text: str, kind: Any):
        path = tmp_path / "mocks.yaml"
        path.write_text(f"given: {text}\n", encoding="utf-8")
        problems = Problems()
        reading = Reading(TableCatalogue({}), problems)
        table = read_file(path, path.name, problems)
        recipe = read_given(table.get("given"), kind, "out", reading)
        told = [problem.message for problem in problems.all()]
        assert (recipe is None) == bool(told)
        maker = Maker(np.random.default_rng(1), lambda what, value: None)
        return (None if recipe is None else recipe(maker)), told

    return given


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("3", int, 3),
        ("3", float, 3),
        ("2.5", float, 2.5),
        ("250 cm", Metres, 2.5),
        ("-2", Metres, -2),
        ("2", Literal[1, 2], 2),
        ("true", bool, True),
        ("word", str, "word"),
        ("'no'", Literal["yes", "no"], "no"),
        ("red", Colour, Colour.RED),
        ("null", float | None, None),
        ("1.5", float | None, 1.5),
        ("1.5", None | float, 1.5),
        ("[1, 2]", list[int], [1, 2]),
        ("[1, 2]", tuple[int, ...], (1, 2)),
        ("[1, two]", tuple[int, str], (1, "two")),
        ("[1, 1, 2]", set[int], {1, 2}),
        ("[red]", frozenset[Colour], frozenset({Colour.RED})),
        ("[]", list[int], []),
        ("[1, {a: 2}]", list, [1, {"a": 2}]),
        ("{a: 2}", dict[str, int], {"a": 2}),
        ("{a: [1, x]}", Any, {"a": [1, "x"]}),
    ],
)
def test_a_value_is_read_by_the_type_of_its_port(given, text, kind, value):
    found, told = given(text, kind)
    assert told == []
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        ("2.5", int, "out is a whole number, not 2.5"),
        ("true", int, "out is a whole number, not true"),
        ("true", float, "out is a number, not true"),
        ("three", float, "out is a number, not 'three'"),
        ("[1]", Metres, "out is a number or a quantity (length), not a list"),
        ("3", Literal[1, 2], "out has no value '3'; there is: 1, 2"),
        ("maybe", Literal["yes", "no"], "out has no value 'maybe'"),
        ("rde", Colour, "out has no value 'rde'. Did you mean 'red'?"),
        ("3", list[int], "out is a list, not 3"),
        ("[1, 2.5, x]", list[int], "out[1] is a whole number, not 2.5"),
        ("[1]", tuple[int, str], "out has 2 items, not 1"),
        ("null", float, "out is a number, not nothing"),
        ("[1, x]", np.ndarray, "out is a number, not 'x'"),
        ("[[1, 2], [3]]", np.ndarray, "out: the rows of an array are of one length"),
        ("5 kg", Metres, "out: "),
    ],
)
def test_a_value_of_another_type_is_told_where_it_stands(given, text, kind, told):
    found, words = given(text, kind)
    assert found is None
    assert words[0].startswith(told)


def test_an_array_and_a_mapping_are_made_anew_for_each_use(given):
    value, _ = given("[[1, 2.5], [3, 4]]", np.ndarray)
    np.testing.assert_array_equal(value, [[1.0, 2.5], [3.0, 4.0]])
    assert value.dtype == float


def test_fields_of_an_object_are_given_and_the_others_are_made_up(given):
    stone, told = given("{size: 50 cm, colours: [grey, red], place: [1, 2, 3]}", Stone)
    assert told == []
    assert isinstance(stone, Stone)
    assert (stone.size, stone.colours) == (0.5, [Colour.GREY, Colour.RED])
    assert stone.place.tolist() == [1.0, 2.0, 3.0]
    assert stone.id in range(6)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("3", ["out is a Stone: give some of its fields, {id: …, size: …, colours: …, place: …}, "
               "not 3"]),
        ("{siez: 1, id: 2.5}",
         ["Stone has no field 'siez'. Did you mean 'size'?", "out.id is a whole number, not 2.5"]),
        ("{siez: 1}", ["Stone has no field 'siez'. Did you mean 'size'?"]),
        ("{colours: [pink]}", ["out.colours[0] has no value 'pink'; there is: grey, red"]),
    ],
)  # fmt: skip
def test_mistakes_in_an_object_are_all_told(given, text, told):
    found, words = given(text, Stone)
    assert found is None
    assert words == told


def test_no_two_uses_share_a_value(tmp_path):
    path = tmp_path / "mocks.yaml"
    path.write_text("a: [1, 2]\nb: {c: [1]}\n", encoding="utf-8")
    problems = Problems()
    reading, table = Reading(TableCatalogue({}), problems), read_file(path, path.name, problems)
    maker = Maker(np.random.default_rng(1), lambda what, value: None)
    kinds: dict[str, typing.Any] = {"a": np.ndarray, "b": dict}
    for key, kind in kinds.items():
        recipe = read_given(table.get(key), kind, key, reading)
        first = recipe(maker)
        if key == "a":
            first[0] = 9.0
        else:
            first["c"].append(9)
        assert "9" not in str(recipe(maker))
