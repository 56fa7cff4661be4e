"""Scripts of BehaviorTree.CPP are read as expressions, and expressions are written as scripts."""

import pytest

from executive.tree.btcpp.read_script import (
    Assignment,
    ScriptError,
    read_assignments,
    read_condition,
    value_of,
)
from executive.tree.btcpp.script import condition_script
from executive.tree.expressions.parser import parse
from executive.tree.expressions.syntax import Number


@pytest.mark.parametrize(
    ("script", "expression"),
    [
        ("a", "{a}"),
        ("a == 1", "{a} == 1"),
        ("a != 'wet'", "{a} != 'wet'"),
        ("a < b", "{a} < {b}"),
        ("a <= b", "{a} <= {b}"),
        ("a > b", "{a} > {b}"),
        ("a >= b", "{a} >= {b}"),
        ("a && b || c", "({a} and {b}) or {c}"),
        ("a || b && c", "{a} or ({b} and {c})"),
        ("!a", "not {a}"),
        ("!(a && b)", "not ({a} and {b})"),
        ("-a + 2 > 0", "-{a} + 2 > 0"),
        ("a + b * c > 0", "{a} + ({b} * {c}) > 0"),
        ("(a + b) * c > 0", "({a} + {b}) * {c} > 0"),
        ("a - b - c > 0", "({a} - {b}) - {c} > 0"),
        ("a / b / c > 0", "({a} / {b}) / {c} > 0"),
        ("a < b < c", "{a} < {b} and {b} < {c}"),
        ("a < b <= c == d", "({a} < {b} and {b} <= {c}) and {c} == {d}"),
        ("done == true", "{done} == true"),
        ("done == false", "{done} == false"),
        ("_a1.b == 1", None),
        ("a ? 1 : 2", None),
        ("a .. b", None),
        ("a & b", None),
        ("(a", None),
        ("a)", None),
        ("a b", None),
        ("", None),
        ("a == #", None),
        ("@a == 1", None),
    ],
)
def test_a_condition_is_read_as_it_binds(script, expression):
    if expression is None:
        with pytest.raises(ScriptError):
            read_condition(script)
    else:
        assert read_condition(script) == parse(expression)


@pytest.mark.parametrize(
    ("token", "value"),
    [
        ("7", 7),
        ("07", 7),
        ("0x1F", 31),
        ("0X1f", 31),
        ("0xE1", 225),
        ("1.5", 1.5),
        ("2.", 2.0),
        (".25", 0.25),
        ("1e3", 1000.0),
        ("2.5E-1", 0.25),
        ("9" * 300, int("9" * 300)),
    ],
)
def test_a_number_is_read_to_the_value_that_it_has_in_a_script(token, value):
    (read,) = read_assignments(f"a := {token}")
    assert read == Assignment("a", Number(value))
    assert type(read.value.value) is type(value)


@pytest.mark.parametrize("token", ["1e999", "9" * 301, "0x" + "f" * 299])
def test_a_number_that_no_mission_can_hold_is_refused(token):
    with pytest.raises(ScriptError, match="is no number of a mission: it is too large"):
        read_condition(f"a == {token}")


@pytest.mark.parametrize(
    ("script", "expression"),
    [
        ("a := b", "{b}"),
        ("a = b", "{b}"),
        ("a += b", "{a} + {b}"),
        ("a -= b", "{a} - {b}"),
        ("a *= b + 1", "{a} * ({b} + 1)"),
        ("a /= b", "{a} / {b}"),
    ],
)
def test_an_assignment_is_what_its_sign_says(script, expression):
    assert read_assignments(script) == [Assignment("a", parse(expression))]


def test_assignments_come_in_order_and_may_end_in_a_semicolon():
    read = read_assignments("a := 1; b := a;")
    assert [one.key for one in read] == ["a", "b"]
    assert read_assignments("a := 1;") == read[:1]


@pytest.mark.parametrize("script", ["a", "a := 1; b", "a == 1", "a := 1 b := 2", "1 := 2"])
def test_what_writes_nothing_is_no_assignment(script):
    with pytest.raises(ScriptError):
        read_assignments(script)


@pytest.mark.parametrize("script", ["a := 1", "a == 1; b == 2", "a; b := 1"])
def test_a_condition_that_writes_is_refused(script):
    with pytest.raises(ScriptError, match="writes keys, and a condition only reads them"):
        read_condition(script)


def value(script):
    (read,) = read_assignments(f"a := {script}")
    return value_of(read.value)


@pytest.mark.parametrize(
    ("script", "written"),
    [("3", 3), ("-3", -3), ("1.5", 1.5), ("true", True), ("false", False), ("'wet'", "wet"),
     ("b", "{b}"), ("-b", "-{b}"), ("b + 1", "{b} + 1"), ("1 + b", "1 + {b}"),
     ("!b", "not {b}")],
)  # fmt: skip
def test_a_value_is_written_as_the_mission_language_writes_it(script, written):
    assert value(script) == written
    assert type(value(script)) is type(written)


@pytest.mark.parametrize(
    ("script", "told"),
    [("'{b}'", "is an expression or a quantity"), ("'3 m'", "is an expression or a quantity"),
     ("1 + 2", "reads no key"), ("!true", "reads no key"), ("-'wet'", "reads no key")],
)  # fmt: skip
def test_a_value_that_a_mission_would_read_otherwise_is_refused(script, told):
    with pytest.raises(ScriptError, match=told):
        value(script)


@pytest.mark.parametrize(("script", "most"), [("a" + "+a" * 100, True), ("a" + "+a" * 101, False)])
def test_a_script_has_at_most_a_hundred_signs(script, most):
    if most:
        read_condition(script)
    else:
        with pytest.raises(ScriptError, match="has more than 100 signs; split it"):
            read_condition(script)


@pytest.mark.parametrize(("levels", "fits"), [(29, True), (30, False)])
@pytest.mark.parametrize(("before", "after"), [("(", ")"), ("-", ""), ("!", "")])
def test_a_script_is_nested_at_most_thirty_levels_deep(before, after, levels, fits):
    script = f"{before * levels}a{after * levels}"
    if fits:
        read_condition(script)
    else:
        with pytest.raises(ScriptError, match="is nested more than 30 levels deep"):
            read_condition(script)


def test_what_stands_side_by_side_is_not_nested():
    read_condition(" + ".join(["(a)"] * 33))


@pytest.mark.parametrize(
    ("expression", "script"),
    [
        ("{a} and {b} or {c}", "a && b || c"),
        ("{a} and ({b} or {c})", "a && (b || c)"),
        ("not ({a} and {b})", "!(a && b)"),
        ("not {a}", "!a"),
        ("-({a} + 1) > 0", "-(a + 1) > 0"),
        ("{a} - ({b} - {c}) > 0", "a - (b - c) > 0"),
        ("({a} - {b}) - {c} > 0", "a - b - c > 0"),
        ("{a} * ({b} + 1) > 0.8 t", "a * (b + 1) > 800.0"),
        ("{a} / ({b} * {c}) > 0", "a / (b * c) > 0"),
        ("({a} < {b}) == ({c} < {d})", "(a < b) == (c < d)"),
        ("{a} == 'wet'", "a == 'wet'"),
        ('{a} == "it\'s"', None),
        ("{a} in [1, 2]", None),
        ("{a.mass} > 1", None),
        ("{a} == true", "a == true"),
        ("{a} > -1", "a > -1"),
    ],
)
def test_a_condition_is_written_as_a_script_if_scripts_can_say_it(expression, script):
    assert condition_script(parse(expression)) == script
