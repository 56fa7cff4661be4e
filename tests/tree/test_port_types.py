"""Which types of ports fit together, as classes and as the names that a mission file writes."""

from collections.abc import Sequence
from typing import Annotated, Any

import pytest

from executive.tree.port_types import fits, fits_name, holds, is_type_name, type_name, type_of


class Stone:
    """A stone."""


class Block(Stone):
    """A stone with flat sides."""


@pytest.mark.parametrize(
    ("have", "wanted"),
    [
        (Stone, Stone),
        (Block, Stone),
        (Any, Stone),
        (Stone, object),
        (int, float),
        (float, float),
        (bool, bool),
        (list[Block], list[Stone]),
        (list[int], list[float]),
        (list, list[Stone]),
        (list[Stone], list),
        (list[Stone], Sequence),
        (Block | None, Stone),
        (Stone, Stone | None),
        (int, str | float),
        (dict[str, int], dict[str, str]),  # only the items of lists are compared
        (tuple[int, ...], tuple[str, ...]),
        (Annotated[Block, "a note"], Stone),
    ],
)
def test_a_value_can_be_read_as_a_wider_type(have, wanted):
    assert fits(have, wanted)


@pytest.mark.parametrize(
    ("have", "wanted"),
    [
        (Stone, Block),
        (str, float),
        (float, int),
        (bool, int),
        (bool, float),
        (int, bool),
        (list[Stone], list[Block]),
        (list[str], list[float]),
        (list[Stone], Stone),
        (Stone, list[Stone]),
        (str, int | None),
        (str | None, float),
    ],
)
def test_a_value_of_another_type_does_not_fit(have, wanted):
    assert not fits(have, wanted)


@pytest.mark.parametrize(
    ("have", "name", "is_fit"),
    [
        (Block, "Stone", True),
        (Stone, "Block", False),
        (Stone, "object", True),
        (Any, "Stone", True),
        (int, "float", True),
        (float, "int", False),
        (list[Block], "list[Stone]", True),
        (list[Stone], "list[Block]", False),
        (list, "list[Stone]", True),
        (Stone, "list[Stone]", False),
        (tuple[Stone, ...], "list[Stone]", False),
        (Stone | None, "Stone", True),
        (Stone | None, "Block", False),
    ],
)
def test_a_type_suits_the_name_that_a_mission_writes(have, name, is_fit):
    assert fits_name(have, name) == is_fit


@pytest.mark.parametrize(
    ("value", "wanted", "is_held"),
    [
        (Block(), Stone, True),
        (Stone(), Block, False),
        (None, Stone | None, True),
        (None, Stone, False),
        (1, float, True),
        (1.0, int, False),
        (True, bool, True),
        (True, int, False),
        (True, float, False),
        (True, object, True),
        (1, bool, False),
        ([Block()], list[Stone], True),
        ([Block(), 1], list[Stone], False),
        ([], list[Stone], True),
        ([1, "a"], list, True),
        ((1,), list[int], False),
        ("a", Any, True),
    ],
)
def test_a_value_is_of_the_type_of_its_port(value, wanted, is_held):
    assert holds(value, wanted) == is_held


@pytest.mark.parametrize(
    ("kind", "name"),
    [(Stone, "Stone"), (Any, "object"), (list[Stone], "list[Stone]"), (list[Any], "list[object]"),
     (float, "float")],
)  # fmt: skip
def test_a_type_is_written_as_missions_write_it(kind, name):
    assert type_name(kind) == name


@pytest.mark.parametrize("name", ["Stone", "Stone?", "list[Stone]", "list[Stone]?", "float"])
def test_a_name_of_a_type_is_one(name):
    assert is_type_name(name)


@pytest.mark.parametrize("name", ["", "?", "Stone??", "list[]", "list[list[Stone]]", "my Stone"])
def test_another_text_is_no_name_of_a_type(name):
    assert not is_type_name(name)


def test_a_literal_has_the_type_of_its_items_if_they_are_alike():
    assert type_of(3) is int
    assert type_of([1, 2]) == list[int]
    assert type_of([[1], [2]]) == list[list[int]]
    assert type_of([1, "a"]) is list
    assert type_of([]) is list
