"""The types and the values of expressions: each operator and function on each sort of value."""

import re
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import product

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.leaf.store import Store
from executive.messages.stone import StoneState
from executive.tree.expressions.checking import UNKNOWN, Typing
from executive.tree.expressions.dimension import NAMED
from executive.tree.expressions.evaluation import evaluate, values_in
from executive.tree.expressions.kinds import fields_of, number
from executive.tree.expressions.parser import is_quantity, parse
from executive.tree.expressions.presence import asked_for
from executive.tree.expressions.template import split_template
from executive.tree.expressions.tokens import ExpressionError


class Other(StrEnum):
    FIRST = "first"


@dataclass
class Thing:
    """A thing.

    Attributes:
        reach_m: How far.
        weight: Its mass [kg].
        angle_ms: A time [s] by its name, which is none.
        state: Its state.
        at: Its place [m].
    """

    reach_m: float
    weight: float
    angle_ms: float
    state: StoneState
    at: np.ndarray
    next: "Thing | None" = None

    @property
    def length_m(self) -> float:
        """Twice the reach."""
        return 2 * self.reach_m


THING = Thing(2.0, 300.0, 5.0, StoneState.PLACED, np.array([3.0, 4.0, 0.0]))
KEYS: dict[str, tuple[typing.Any, object]] = {
    "n": (int, 3),
    "x": (float, -1.5),
    "d": (number(NAMED["length"]), 2.0),
    "b": (bool, True),
    "s": (str, "placed"),
    "c": (StoneState, StoneState.PLACED),
    "e": (Other, Other.FIRST),
    "l": (list[int], [1, 2, 3]),
    "p": (tuple[float, ...], (1.0, 2.5)),
    "q": (tuple[int, str], (1, "a")),
    "a": (np.ndarray, np.array([1.0, -2.0])),
    "m": (Mapping[str, float], {"a": 1.0}),
    "t": (Thing, THING),
    "u": (Thing | None, None),
    "i": (int | str, 4),
    "z": (list[Thing], [THING, Thing(1.0, 2.0, 3.0, StoneState.HELD, np.zeros(3), THING)]),
    "w": (object, "anything"),
}
OPERATORS = ("+", "-", "*", "/", "<", "<=", "==", "!=", "in", "not in", "and", "or")
WRITTEN = ("2", "2.5", "2 m", "-90 deg", "'held'", "true", "[1, 2]", "['held', 'x']", "[]")
OVERS = [f"{word}(k in {{{key}}}: {body})" for word, key, body in product(
    ("any", "all", "count", "only", "each"),
    "lpqzmnw",
    ("{k} > 1", "{k.reach} > 1 m", "{k}"),
)]  # fmt: skip
SINGLE = (
    *(f"{{t.{name}}}" for name in ("reach_m", "reach", "weight", "angle_ms", "state", "at", "no")),
    *("{t.length}", "{t.next.reach}", "{u.reach}", "{z[0].next}", "{z[1].next.reach}", "{z[9]}"),
    *("{l[0]}", "{l[3]}", "{l['a']}", "{m['a']}", "{m['b']}", "{m[0]}", "{n[0]}"),
    *("{a[1]}", "{t.at[0]}", "{q[1]}", "{none}", "{none.reach}", "-{s}", "-{d}"),
    *("not {b}", "not {n}", "not not {b}", "len({l})", "len({s})", "len({n})", "len({a})"),
    *("min({l})", "max({p})", "sum({p})", "sum({z})", "min({n}, {x})", "max({d}, 3 m)"),
    *("max({d}, {n})", "max({d}, 3)", "min({d}, 3 s)", "min({s})", "sum({l}, {l})", "min()"),
    *("abs({x})", "abs({d})", "abs({s})", "abs()", "distance({t.at}, {t.at})", "distance({l}, 1)"),
    *("distance({t.at}, [0, 0, 0])", "distance({a}, {p})"),
    *("distance({t.at}, {a})", "text({x}, 'a')"),
    *("text({b}, {c}, {l}, {d})", "text()", "has({u})", "has({none})", "has({t.next})", "has(3)"),
    *("has({l[9]})", "has({t.no})", "has({z[0].next.reach})", "default({none}, 3)", "default({n})"),
    *("default({t.next}, {t})", "default({u}, 2)", "default({l[7]}, 0)", "has()", "has({n}, {n})"),
    *("has({u}) and {u.reach} > 1 m", "has({u.next}) and {u.next.reach} > 1 m", "{u.reach} > 1"),
    *("not has({u}) or {u.reach} > 1 m", "has({u}) or {u.reach} > 1 m", "{d} * {d} / {d} > 2 m"),
    *("{d} / 2 s > 1 m/s", "{d} / 2 s > 1 m", "{n} * 1 m > {d}"),
    *("{n} > {d}", "2 > {d}", "{x} > 1 m"),
    *("{t.weight} > 0.2 t", "{t.reach} in [1 m, 2 m]", "{c} == 'plaeced'", "{c} == 'placed'"),
    *("{c} in ['placed', 'x']", "{c} == {e}", "{c} < {c}", "{s} < 'q'", "{b} < {b}", "{l} == {l}"),
    *("{t} == {t}", "'a' in {m}", "{n} in {m}", "'l' in {s}"),
    *("{n} in {s}", "{q} + {l}", "{s} + 'x'"),
    *("{s} + 1", "1 / 0", "{l} + {p}", "{x} * {s}", "[{n}, {s}]"),
    *("[{d}, 1 s]", "1 + 2 * 3 - 4 / 5"),
    *("1 - 2 - 3", "-2 * -3", "1 < 2 and 2 < 3 or false", "count(k in {z}: {k.state} == 'held')"),
    *("any(k in {z}: any(j in {l}: {j} > {k.reach} / 1 m))",),
    *("len(only(k in {z}: {k.reach} > 1.5 m))", "only(k in {z}: {k.reach} > 1.5 m)"),
    *("each(k in {z}: {k.weight})", "max(each(k in {z}: {k.weight})) > 200 kg"),
)  # fmt: skip
BROKEN = (
    *("{l[-1]}", "{l[true]}", "{l[{n}]}", "only(k in {z}: true)[0]"),
    *("", " ", "{", "{}", "{a", "{a.}", "{a[}", "{a[0}", "{a]}", "(1"),
    *("1)", "[1", "[1,", "[,]", "1 2"),
    *("1 +", "+ 1", "* 2", "a", "a.b", "len", "len(", "len(1", "any", "any(", "any(k", "any(k in"),
    *("any(k in {l}", "any(k in {l}: 1", "any({l})", "any(1 in {l}: 1)"),
    *("'a", '"a"', "1 tt", "1 m/h"),
    *("1e3", ".5", "5.", "1..2", "1 = 2", "1 <> 2", "1 && 2", "1 || 2"),
    *("! 1", "1 < 2 < 3", "{a} ? 1"),
    *("{a b}", "{A}", "{1}", "{a.1}", "{in}", "{a.and}", "not", "in"),
    *("1 in", "true false", "1 min / 2"),
    *("2 m / s", "2 m/s", "3 % 2", "2 ^ 2", "2 ** 2", "{a}.b", "{a}[0]"),
    *("#", "1\n+ 2", "'it''s'", "x" * 2001),
)  # fmt: skip
TEMPLATES = (
    *("", "plain", "{a}", "{a} m", "a {b} c {d.e[0]}", "{{a}}", "{a"),
    *("a}", "{}", "{a}{b}", "{a + 1}"),
    *("{a or}", "has {a}", "it's {b}", "{ a }", "{a.b.c} {len({d})}"),
)  # fmt: skip


def typed(text: str, *, has_words: bool = True) -> str:
    """Return the types of an expression and its mistakes, in a line."""
    told: list[str] = []

    def fail(at: int, message: str) -> None:
        told.append(f"{at}: {message}" if has_words else f"{at}")

    def key(one, may_miss):
        if one.name in KEYS:
            return frozenset({KEYS[one.name][0]})
        if one.name == "k":
            return UNKNOWN
        if may_miss:
            return frozenset({type(None)})
        told.append(f"{one.at}: none")
        return frozenset()

    try:
        found = Typing(key, fail).types(parse(text))
    except ExpressionError as error:
        return f"{error.at}: {error}"
    return f"{sorted(map(words, found))} {told}"


def words(kind: object) -> str:
    """Return the words of a type, sorted: Python orders the parts of a union as it met them."""
    return " ".join(sorted(re.findall(r"[\w.]+", str(kind))))


def valued(text: str) -> str:
    try:
        value = evaluate(parse(text), Store({name: value for name, (_, value) in KEYS.items()}))
    except (ConfigError, ExpressionError) as error:
        return str(error)
    return str(value)


def lines(texts, of) -> dict[str, str]:
    return {text: of(text) for text in texts}


@pytest.mark.parametrize("of", [typed, valued])
def test_single(recorded, of) -> None:
    recorded(lines(SINGLE, of))


@pytest.mark.parametrize("of", [typed, valued])
def test_overs(recorded, of) -> None:
    recorded(lines(OVERS, of))


@pytest.mark.parametrize("operator", OPERATORS)
def test_operators(recorded, operator) -> None:
    """Of each pair alone the kind of the answer, and which messages there are."""
    sides = (*(f"{{{name}}}" for name in KEYS), *WRITTEN)
    # Which member of a union a message names depends on the order in which Python met them.
    for of in (partial(typed, has_words=False), valued):
        told = {left: [of(f"{left} {operator} {right}") for right in sides] for left in sides}
        texts = sorted({one for row in told.values() for one in row})
        rows = {left: " ".join(str(texts.index(one)) for one in row) for left, row in told.items()}
        short = [text[:60] for text in texts]
        recorded((" | ".join(short[::5]), len(texts), rows))


def test_broken(recorded) -> None:
    def of(text: str) -> str:
        try:
            return str(parse(text))
        except ExpressionError as error:
            return f"{error.at}: {error}"

    recorded({text[:40]: of(text) for text in BROKEN})


def test_templates(recorded) -> None:
    def of(text: str) -> str:
        try:
            return str([str(one) for one in split_template(text)])
        except ExpressionError as error:
            return f"{error.at}: {error}"

    recorded(lines(TEMPLATES, of))


def test_what_is_read_and_asked_for(recorded) -> None:
    store = Store({name: value for name, (_, value) in KEYS.items()})
    whole = [text for text in SINGLE if "['" not in text]
    recorded(lines(whole[:70], lambda text: values_in(parse(text), store)))
    asked = [text for text in whole if "has(" in text]
    recorded(lines(asked, lambda text: [sorted(asked_for(parse(text), yes)) for yes in (0, 1)]))
    recorded(lines((*WRITTEN, "3 rad", "- 3 m", "{d}", "3 m + 1", "m", "1 m 2"), is_quantity))


def test_fields(recorded) -> None:
    recorded({name: str(kind) for name, kind in fields_of(Thing).items()})
