"""The language of expressions by its properties: printing and reading, Python's arithmetic, and no
text that crashes the checker.
"""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from executive.config import UNITS
from executive.errors import ConfigError
from executive.leaf.store import Store
from executive.tree.expressions.checking import UNKNOWN, Typing
from executive.tree.expressions.dimension import unit_dimension
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.parser import OVERS, parse
from executive.tree.expressions.syntax import (
    BINDING,
    Binary,
    Field,
    Function,
    Index,
    Key,
    Listed,
    Number,
    Over,
    Text,
    Truth,
    Unary,
)
from executive.tree.expressions.template import split_template
from executive.tree.expressions.tokens import ExpressionError

_WORDS = {"and", "or", "not", "in", "true", "false"}
_UNITS = [unit for units in UNITS.values() for unit in units]
names = st.from_regex(r"[a-z_][a-z0-9_]{0,5}", fullmatch=True).filter(lambda n: n not in _WORDS)
numbers = st.builds(
    Number,
    st.integers(0, 10**6) | st.floats(0, 1e12, allow_nan=False),
    st.sampled_from(["", *_UNITS]),
)
texts = st.builds(Text, st.text("abc 'é{}x", max_size=5))


PIECES = [
    *("{a}", "{a.b}", "{", "}", "(", ")", "[", "]", ",", ".", ":", "=", "<", "==", "+", "-", "*"),
    *("3", "0.8", "t", "m/s", "'x'", "and", "or", "not", "in", "/", "len", "any", "true"),
]


def larger(parts: st.SearchStrategy) -> st.SearchStrategy:
    several = st.lists(parts, max_size=3).map(tuple)
    return st.one_of(
        st.builds(Field, parts, names),
        st.builds(Index, parts, parts),
        st.builds(Listed, several),
        st.builds(Unary, st.sampled_from(["-", "not"]), parts),
        st.builds(
            Binary,
            st.sampled_from(list(BINDING)).filter(lambda op: op != "not"),
            parts,
            parts,
        ),
        st.builds(Function, st.sampled_from(["len", "min", "max", "has", "default"]), several),
        st.builds(Over, st.sampled_from(OVERS), names, parts, parts),
    )  # fmt: skip


atoms = st.one_of(numbers, texts, st.builds(Truth, st.booleans()), st.builds(Key, names))
expressions = st.recursive(atoms, larger, max_leaves=12)


@given(expressions)
@settings(max_examples=300)
def test_what_is_written_reads_as_the_same(expression) -> None:
    assert parse(str(expression)) == expression


def parses(text: str) -> bool:
    try:
        parse(text)
    except ExpressionError:
        return False
    return True


arithmetic = st.recursive(
    st.integers(0, 99).map(str) | st.sampled_from(["{a}", "{b}"]),
    lambda parts: st.one_of(
        st.tuples(parts, st.sampled_from("+-*/"), parts).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        st.tuples(parts, st.sampled_from("+-*/"), parts).map(lambda t: f"{t[0]} {t[1]} {t[2]}"),
        parts.map(lambda part: f"-{part}"),
        st.tuples(parts, st.sampled_from(["<", "<=", "==", "!="]), parts).map(
            lambda t: f"len([{t[0]} + 0 {t[1]} {t[2]} - 0])"
        ),
        st.tuples(parts, parts).map(lambda t: f"max({t[0]}, {t[1]})"),
    ),
    max_leaves=10,
)


@given(arithmetic, st.integers(-9, 9), st.floats(-9, 9))
@settings(max_examples=300)
def test_arithmetic_agrees_with_pythons(text: str, a: int, b: float) -> None:
    python = text.replace("{", "(").replace("}", ")")
    try:
        expected = eval(python, {"a": a, "b": b, "len": len, "max": max, "__builtins__": {}})
    except (ArithmeticError, TypeError):
        with pytest.raises(ConfigError, match="cannot be computed"):
            evaluate(parse(text), Store({"a": a, "b": b}))
        return
    got = evaluate(parse(text), Store({"a": a, "b": b}))
    assert got == expected or (math.isnan(got) and math.isnan(expected))


@given(
    st.text(max_size=60)
    | st.lists(
        st.sampled_from(PIECES),
        max_size=20,
    ).map(" ".join)
)
@settings(max_examples=500)
def test_no_text_crashes_the_parser_the_checker_or_a_template(text: str) -> None:
    told: list[tuple[int, str]] = []
    for read in (parse, split_template):
        try:
            read(text)
        except ExpressionError as error:
            told.append((error.at, str(error)))
    typing = Typing(lambda key, _: UNKNOWN, lambda at, message: told.append((at, message)))
    if parses(text):
        typing.types(parse(text))
    assert all(0 <= at <= len(text) and message for at, message in told)


@pytest.mark.parametrize("text", ["(" * 5000, "-" * 5000, "[" * 400, "not " * 400, "1+" * 900])
def test_deep_texts_are_refused_and_not_followed(text: str) -> None:
    with pytest.raises(ExpressionError):
        parse(text)


@pytest.mark.parametrize(
    ("unit", "value"), [("t", 1000), ("deg", math.pi / 180), ("km/h", 1 / 3.6), ("min", 60)]
)
def test_quantities_are_si_inside(unit: str, value: float) -> None:
    assert evaluate(parse(f"2 {unit}"), Store()) == pytest.approx(2 * value, rel=1e-12)


def test_every_unit_has_the_dimension_of_its_name() -> None:
    for dimension, units in UNITS.items():
        for unit in units:
            assert str(unit_dimension(unit)) == dimension


@pytest.mark.parametrize(
    ("text", "at", "told"),
    [
        ("{a} >", 5, "the expression ends where a value is expected"),
        ("{a} > 3 tt", 8, "'tt' is not a unit. Did you mean 't'?"),
        ("{a} = 3", 4, "'=' cannot stand here; compare with '=='"),
        ("{a} && {b}", 4, "'&' cannot stand here; write 'and'"),
        ("a > 3", 0, "'a' is no value; a key stands in braces, {a}, and a text in quotes"),
        ("lenn({a})", 0, "no function 'lenn'. Did you mean 'len'?"),
        ("len {a}", 0, "'len' is no value; a function is written 'len(…)'"),
        ("1 < {a} < 3", 8, "comparisons are not chained; write '1 < {a} and {a} < …'"),
        ("{a b}", 3, "expected '}', got 'b'"),
        ("({a} + 1", 8, "the expression ends where ')' is expected"),
        ("any({a})", 4, "'any' is written 'any(one in {list}: {one} …)'"),
    ],
)
def test_mistakes_have_a_place_and_a_cure(text: str, at: int, told: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    assert (caught.value.at, str(caught.value)) == (at, told)
