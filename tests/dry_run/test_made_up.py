"""Values are made up by their type, within the bounds of their dimension, alike for equal seeds."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, Literal

import numpy as np
import pytest

from executive.dry_run.made_up import Maker
from executive.errors import ConfigError
from executive.tree.expressions.dimension import NAMED


class Colour(StrEnum):
    GREY = "grey"
    RED = "red"


@dataclass(frozen=True)
class Stone:
    """A stone.

    Attributes:
        id: Its number.
        place: Where it lies [m], shape (3,).
        T_map_object: Its pose, shape (4, 4).
    """

    id: int
    place: np.ndarray
    T_map_object: np.ndarray

    @property
    def points(self) -> np.ndarray:
        """Its surface [m], shape (N, 3)."""
        raise NotImplementedError

    def volume(self) -> str:
        """Return a figure that is computed from a field."""
        return f"volume of {self.id}"


def makers(count: int = 300) -> list[Maker]:
    return [Maker(np.random.default_rng(n), lambda what, value: None) for n in range(count)]


def drawn(kind: Any) -> list[Any]:
    """Return what three hundred seeds make up."""
    return [maker.make(kind, "it") for maker in makers()]


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (bool, {True, False}),
        (Colour, set(Colour)),
        (Literal["a", "b"], {"a", "b"}),
        (Literal[1, 5], {1, 5}),
        (int, set(range(6))),
        (str, {"made up"}),
        (Any, {"made up"}),
        (type(None), {None}),
        (tuple[Literal[1], Literal["x"]], {(1, "x")}),
        (tuple[Literal[1], ...], {(), (1,), (1, 1), (1, 1, 1)}),
        (frozenset[Literal[1]], {frozenset(), frozenset({1})}),
    ],
)
def test_each_value_of_a_type_is_drawn_at_times(kind, values):
    assert set(drawn(kind)) == values


def test_a_list_has_up_to_three_items_and_a_mapping_none():
    assert {len(one) for one in drawn(list[int])} == {0, 1, 2, 3}
    assert all(type(one) is list for one in drawn(list[int]))
    assert {str(one) for one in drawn(dict[str, int])} == {"{}"}


def test_truth_and_falsehood_are_drawn_evenly():
    # Of 300 fair draws fewer than 110 or more than 190 are true with a probability below 1e-5.
    assert 110 < sum(drawn(bool)) < 190


@pytest.mark.parametrize(
    ("dimension", "low", "high"),
    [
        (None, 0.0, 1.0),
        ("length", 0.0, 5.0),
        ("mass", 100.0, 2000.0),
        ("angle", -math.pi, math.pi),
        ("time", 0.0, 60.0),
        ("volume", 0.05, 1.0),
        ("force", 0.0, 1.0),
    ],
)
def test_a_number_is_drawn_from_the_range_of_its_dimension(dimension, low, high):
    kind = Annotated[float, NAMED[dimension]] if dimension else float
    found = np.array(drawn(kind))
    assert low <= found.min() < low + 0.05 * (high - low)
    assert high - 0.05 * (high - low) < found.max() <= high


@pytest.mark.parametrize(
    ("doc", "shape"),
    [
        ("Places, shape (N, 3).", (4, 3)),
        ("A place, shape (3,).", (3,)),
        ("A value, shape ().", ()),
        ("Turns, each (2, 2).", (2, 2)),
    ],
)
def test_an_array_has_the_shape_that_its_text_states(doc, shape):
    found = makers(1)[0].make(np.ndarray, "it", doc)
    assert np.shape(found) == shape
    assert np.all(np.abs(found) <= 5.0)


def test_a_pose_is_level_and_within_five_metres():
    poses = np.array(
        [maker.make(np.ndarray, "it", "Its pose, shape (4, 4).") for maker in makers()]
    )
    np.testing.assert_array_equal(poses[:, :3, :3], np.broadcast_to(np.eye(3), (300, 3, 3)))
    np.testing.assert_array_equal(poses[:, 3], np.broadcast_to([0.0, 0, 0, 1], (300, 4)))
    places = poses[:, :3, 3]
    assert -5.0 <= places.min() < -4.5
    assert 4.5 < places.max() <= 5.0


def test_an_array_without_a_stated_shape_is_refused():
    with pytest.raises(ConfigError, match="'it' cannot be made up: its docstring states no shape"):
        makers(1)[0].make(np.ndarray, "it", "A few numbers.")


def test_a_field_is_made_up_once_when_it_is_read_and_told():
    told = []
    maker = Maker(np.random.default_rng(3), lambda what, value: told.append((what, value)))
    stone = maker.make(Stone, "scan.stone")
    assert isinstance(stone, Stone)
    assert told == []
    number = stone.id
    assert stone.id == number
    assert stone.volume() == f"volume of {number}"
    assert told == [("scan.stone.id", number)]
    assert stone.place.shape == (3,)
    assert stone.points.shape == (4, 3)
    assert [what for what, _ in told] == ["scan.stone.id", "scan.stone.place", "scan.stone.points"]


def test_a_field_that_a_file_gives_is_not_made_up():
    told = []
    maker = Maker(np.random.default_rng(3), lambda what, value: told.append(what))
    stone = maker.stand_in(Stone, "stone", {"id": lambda maker: 77})
    assert (stone.id, stone.volume(), told) == (77, "volume of 77", [])


def test_a_stand_in_is_itself_alone():
    maker = makers(1)[0]
    one, other = maker.make(Stone, "a"), maker.make(Stone, "a")
    assert one == one
    assert one != other
    assert len({one, other, one}) == 2
    assert repr(one) == "Stone (made up)"


def test_a_class_that_nothing_may_derive_from_is_refused():
    with pytest.raises(ConfigError, match=r"no slice can be made up for 'it': .*; leave its leaf"):
        makers(1)[0].stand_in(slice, "it", {})


def test_equal_seeds_make_up_equal_values():
    kinds = (int, float, list[int], Colour, tuple[float, float])
    runs = [
        [maker.make(kind, "it") for kind in kinds]
        for maker in (Maker(np.random.default_rng(5), lambda *_: None) for _ in range(2))
    ]
    assert runs[0] == runs[1]
