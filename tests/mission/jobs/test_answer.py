"""What a plugin returns is held to the annotation of its interface."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
import pytest

from executive.interfaces.plugin import Plugin
from executive.mission.jobs.answer import unfit


@dataclass(frozen=True)
class Plan:
    """A plan.

    Attributes:
        cost: What it costs.
    """

    cost: float = 1.0


class Verbs(Plugin):
    """An interface with a verb of each kind of answer."""

    capability = "verbs"

    def nothing(self) -> None: ...
    def plan(self) -> Plan: ...
    def perhaps(self) -> Plan | None: ...
    def number(self) -> float: ...
    def count(self) -> int: ...
    def truth(self) -> bool: ...
    def pair(self) -> tuple[int, str]: ...
    def plans(self) -> tuple[Plan, ...]: ...
    def row(self) -> Sequence[float]: ...
    def by_name(self) -> Mapping[str, int]: ...
    def sort(self) -> Literal["a", "b"]: ...
    def marked(self) -> Annotated[int, "in pixels"]: ...
    def anything(self) -> Any: ...
    def array(self) -> np.ndarray: ...
    def bare(self) -> list: ...
    def unknown(self) -> "NotThere": ...  # noqa: F821
    def free(self): ...


class Mine(Verbs):
    """A plugin; what it says of its own answers does not count."""

    def plan(self) -> dict: ...
    def own(self) -> int: ...


@pytest.mark.parametrize(
    ("verb", "value"),
    [
        ("nothing", None),
        ("plan", Plan()),
        ("perhaps", None),
        ("perhaps", Plan()),
        *(("number", value) for value in (1.5, 2, np.float32(1.0), np.int64(3), float("inf"))),
        *(("count", value) for value in (2, np.int8(2), -1)),
        *(("truth", value) for value in (True, False, np.True_)),
        ("pair", (1, "a")),
        *(("plans", value) for value in ((), (Plan(),), (Plan(), Plan(), Plan()))),
        *(("row", value) for value in ([], [1.0, 2], (1.0,))),
        *(("by_name", value) for value in ({}, {"a": 1})),
        *(("sort", value) for value in ("a", "b")),
        ("marked", 3),
        *(("anything", value) for value in (None, 1, "a", [])),
        ("array", np.zeros(3)),
        ("bare", ["a", 1]),
        *((verb, value) for verb in ("unknown", "free", "own", "absent") for value in (1, "a")),
    ],
)
def test_an_answer_of_the_declared_type_is_taken(verb, value):
    assert unfit(Mine(), verb, value) == ""


@pytest.mark.parametrize(
    ("verb", "value", "told"),
    [
        ("nothing", 1, "int instead of NoneType"),
        ("plan", None, "NoneType instead of Plan"),
        ("plan", {}, "dict instead of Plan"),
        ("perhaps", 1, "int instead of "),
        ("number", "1", "str instead of float"),
        ("number", True, "bool instead of float"),
        ("number", False, "bool instead of float"),
        ("number", 1j, "complex instead of float"),
        ("count", 1.0, "float instead of int"),
        ("count", True, "bool instead of int"),
        ("truth", 1, "int instead of bool"),
        ("truth", None, "NoneType instead of bool"),
        ("pair", (1,), "a tuple of 1 instead of 2"),
        ("pair", (1, "a", "b"), "a tuple of 3 instead of 2"),
        ("pair", (1, 2), "int instead of str within it"),
        ("pair", [1, "a"], "list instead of "),
        ("plans", [Plan()], "list instead of "),
        ("plans", (Plan(), 1), "int instead of Plan within it"),
        ("row", [1.0, "a"], "str instead of float within it"),
        ("row", 1.0, "float instead of "),
        ("row", np.zeros(3), "ndarray instead of "),
        ("by_name", {"a": "b"}, "str instead of int within it"),
        ("by_name", [("a", 1)], "list instead of "),
        ("sort", "c", "'c' instead of "),
        ("marked", "3", "str instead of int"),
        ("array", [1.0], "list instead of ndarray"),
        ("bare", (1,), "tuple instead of list"),
    ],
)
def test_another_answer_is_told_with_what_it_should_be(verb, value, told):
    assert unfit(Mine(), verb, value).startswith(told)


@pytest.mark.parametrize(
    ("verb", "value"),
    [("number", float("nan")), ("plan", Plan(float("nan"))), ("array", np.array([0.0, np.nan])),
     ("row", [1.0, float("nan")]), ("anything", [Plan(float("nan"))])],
)  # fmt: skip
def test_no_answer_holds_a_nan(verb, value):
    assert unfit(Mine(), verb, value).startswith("NaN (")


def test_of_a_long_answer_the_first_thousand_elements_are_checked():
    assert unfit(Mine(), "row", [1.0] * 999 + ["a"])
    assert unfit(Mine(), "row", [1.0] * 1000 + ["a"]) == ""
    assert unfit(Mine(), "by_name", {i: 1 if i < 999 else "a" for i in range(1000)})
    assert unfit(Mine(), "by_name", {i: 1 if i < 1000 else "a" for i in range(1001)}) == ""
