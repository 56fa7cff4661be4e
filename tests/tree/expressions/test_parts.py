"""Single parts of the language: what is read of a key, what a value is shown as, and refusals."""

import re
from collections import OrderedDict
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, NewType

import pytest

from executive.errors import ConfigError
from executive.leaf.store import Store
from executive.tree.expressions.dimension import NAMED, PLAIN, Dimension, in_si, unit_dimension
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.kinds import bare
from executive.tree.expressions.parser import parse
from executive.tree.expressions.syntax import Key, keys_of, parts_of
from executive.tree.expressions.tokens import ExpressionError, tokens


class Side(Enum):
    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True)
class Stone:
    """A stone.

    Attributes:
        mass_kg: Mass [kg].
        side: Where it lies.
        sizes: Its sizes by name.
    """

    mass_kg: float
    side: Side
    sizes: dict[str, float]


STONE = Stone(1200.0, Side.LEFT, {"x": 2.0})
StoneId = NewType("StoneId", int)
OtherId = NewType("OtherId", StoneId)


def value(text: str, **keys: Any) -> Any:
    store = Store()
    for key, one in keys.items():
        store.set(key, one)
    return evaluate(parse(text), store)


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("{sizes}['x'] == 2", True),
        ("{stone.mass} >= 1.2 t", True),
        ("{list[0]} + {list[2]}", 40),
        ("[1, 2, 3][-1]", 3),
        ("[1, 2, 3][-3]", 1),
        ("any(x in {list}: {x} > 25)", True),
        ("all(x in {list}: {x} > 15)", False),
    ],
)
def test_parts_of_values_are_read(text: str, result: Any) -> None:
    found = value(text, sizes=OrderedDict(x=2), stone=STONE, list=[10, 20, 30])
    assert found == result


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[1, 2, 3][3]", "there is no item 3 in a list of 3"),
        ("[1, 2, 3][-4]", "there is no item -4 in a list of 3"),
        ("[1, 2, 3][0.5]", "an item's number is whole, not 0.5"),
        ("[1, 2, 3][true]", "an item's number is whole, not True"),
        ("{sizes}['y']", "there is no entry 'y'"),
        ("{stone.mas}", "Stone has no field 'mas'. Did you mean"),
    ],
)
def test_parts_that_are_not_there_are_told(text: str, told: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(told)):
        value(text, sizes={"x": 2}, stone=STONE)


def test_keys_of_an_expression_are_those_of_the_store() -> None:
    one = parse("any(s in {stones}: {s.mass} > {least} and {other}) or {s} > len({stones})")
    assert [key.name for key in keys_of(one)] == ["stones", "least", "other", "s", "stones"]


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("{a} + {b}", ["{a}", "{b}"]),
        ("not {a}", ["{a}"]),
        ("{a.b}", ["{a}"]),
        ("[{a}, 2]", ["{a}", "2"]),
        ("max({a}, {b})", ["{a}", "{b}"]),
        ("any(x in {a}: {x})", ["{a}", "{x}"]),
        ("{a}[{b}]", ["{a}", "{b}"]),
        ("{a}", []),
        ("3", []),
    ],
)
def test_parts_are_those_directly_below(text: str, parts: list[str]) -> None:
    assert [str(one) for one in parts_of(parse(text))] == parts


@pytest.mark.parametrize(
    "text",
    ["{a[0].b}", "{a}[{b}].c", "{a}[1 m].b", "{a}[-1].b", "(3).real", "[1, 2][0].real",
     "(-{a}).real", "({a} + {b})[0]", "max({a}, 1).real"],
)  # fmt: skip
def test_paths_are_written_as_they_are_read(text: str) -> None:
    written = str(parse(text))
    assert parse(written) == parse(text)
    assert str(parse(written)) == written


def test_a_path_of_plain_steps_stands_within_one_pair_of_braces() -> None:
    assert str(parse("{a[0].b}")) == "{a[0].b}"
    assert str(parse("{a}[{b}].c")) == "{a}[{b}].c"


def test_a_number_beyond_all_bounds_is_refused() -> None:
    with pytest.raises(ExpressionError, match="this number is too large") as caught:
        parse("{a} > 1e999")
    assert caught.value.at == 6
    with pytest.raises(ExpressionError, match="too large"):
        parse("9" * 400)
    assert str(parse("9" * 299)) == "9" * 299


def test_words_know_where_they_begin_and_end() -> None:
    found = tokens("{ab} >= 12.5 kg")
    assert [(one.letters, one.at, one.end) for one in found][1] == ("ab", 1, 3)
    sign = next(one for one in found if one.letters == ">=")
    assert (sign.kind, sign.at, sign.end) == ("sign", 5, 7)


def test_names_of_types_are_taken_off() -> None:
    assert bare(OtherId) is int
    assert bare(StoneId) is int
    assert bare(Literal["a"]) == Literal["a"]
    assert bare(int) is int


LENGTH, ANGLE, SHARE = unit_dimension("m"), unit_dimension("rad"), NAMED["length"] / NAMED["length"]


@pytest.mark.parametrize(
    ("one", "other", "suits"),
    [
        (LENGTH, LENGTH, True),
        (LENGTH, unit_dimension("kg"), False),
        (LENGTH * ANGLE, LENGTH, True),  # an arc
        (ANGLE, LENGTH, False),
        (ANGLE, SHARE, True),
        (ANGLE * ANGLE, ANGLE, False),
        (ANGLE * ANGLE, SHARE, True),
        (PLAIN, LENGTH, True),
    ],
)
def test_the_radian_counts_only_where_nothing_else_does(
    one: Dimension, other: Dimension, suits: bool
) -> None:
    assert one.suits(other) is suits
    assert other.suits(one) is suits


def test_quantities_are_in_si() -> None:
    assert in_si(3.0, "t") == 3000.0
    assert in_si(3, "") == 3
    assert in_si(500, "ms") == 0.5


def test_a_key_is_a_part_of_nothing() -> None:
    assert parts_of(Key("a")) == ()
