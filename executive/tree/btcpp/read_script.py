"""Scripts of BehaviorTree.CPP 4 as expressions and values of a mission."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from executive.tree.expressions.parser import is_quantity
from executive.tree.expressions.syntax import (
    Binary,
    Expression,
    Key,
    Number,
    Text,
    Truth,
    Unary,
)

_TOKEN = re.compile(
    r"\s*(?:(?P<number>0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"|(?P<text>'[^']*')|(?P<name>[A-Za-z_@$][\w.@$]*)"
    r"|(?P<sign>:=|\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||\.\.|[-+*/<>!=()?:;&|^~]))"
)
_LEVELS: tuple[Mapping[str, str], ...] = (
    {"||": "or"},
    {"&&": "and"},
    {sign: sign for sign in ("==", "!=", "<", "<=", ">", ">=")},
    {"+": "+", "-": "-"},
    {"*": "*", "/": "/"},
)
_COMPARING = 2  # the level of comparisons, which chain: a < b < c
_ASSIGNMENTS = (":=", "=", "+=", "-=", "*=", "/=")
_MOST = 100  # signs of a script, as many as an expression of a mission may have
_DEEPEST = 30
_LONGEST_NUMBER = 300  # digits of the largest double, and some
_NAMES = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class ScriptError(ValueError):
    """A script that the mission language cannot say; the message says what of it."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """What a script writes to a key."""

    key: str
    value: Expression


def read_condition(text: str) -> Expression:
    """Return a script that gives a truth value, as an expression.

    Raises:
        ScriptError: If expressions cannot say it.
    """
    statements = _statements(text)
    if len(statements) != 1 or isinstance(statements[0], Assignment):
        raise ScriptError(f"'{text}' writes keys, and a condition only reads them")
    return statements[0]


def read_assignments(text: str) -> list[Assignment]:
    """Return what a script writes, in order.

    Raises:
        ScriptError: If `set` cannot say it.
    """
    assignments: list[Assignment] = []
    for one in _statements(text):
        if not isinstance(one, Assignment):
            raise ScriptError(f"'{text}' computes a value that nothing takes")
        assignments.append(one)
    return assignments


def value_of(expression: Expression) -> Any:
    """Return an expression as the mission language writes a value.

    Raises:
        ScriptError: If it is a text that the language would read as something else.
    """
    match expression:
        case Number(value=value) | Truth(value=value):
            return value
        case Unary(op="-", of=Number(value=value)):
            return -value
        case Text(value=value):
            if "{" in value or is_quantity(value):
                raise ScriptError(f"the text '{value}' is an expression or a quantity in a mission")
            return value
    if not _has_key(expression):
        raise ScriptError(f"'{expression}' reads no key; write its value")
    return str(expression)


def _has_key(one: Expression) -> bool:
    if isinstance(one, Binary):
        return _has_key(one.left) or _has_key(one.right)
    return isinstance(one, Key) or (isinstance(one, Unary) and _has_key(one.of))


def _statements(text: str) -> list[Expression | Assignment]:
    parser = _Parser(text)
    found = [parser.statement()]
    while parser.take(";"):
        if not parser.is_done:
            found.append(parser.statement())
    parser.end()
    return found


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens: list[tuple[str, str]] = []
        place = 0
        while text[place:].strip():
            match = _TOKEN.match(text, place)
            if match is None:
                raise ScriptError(f"'{text}': unknown '{text[place:].strip()[0]}'")
            kind = str(match.lastgroup)
            self._tokens.append((kind, match.group(kind)))
            place = match.end()
        if sum(kind == "sign" for kind, _ in self._tokens) > _MOST:
            raise ScriptError(f"'{text[:40]}…' has more than {_MOST} signs; split it")
        self._next = self._depth = 0

    @property
    def is_done(self) -> bool:
        return self._next == len(self._tokens)

    def _peek(self, ahead: int = 0) -> tuple[str, str]:
        place = self._next + ahead
        return self._tokens[place] if place < len(self._tokens) else ("end", "")

    def take(self, sign: str) -> bool:
        """Go past a sign, if it is the next token."""
        if self._peek() == ("sign", sign):
            self._next += 1
            return True
        return False

    def end(self) -> None:
        """Refuse what is left."""
        if not self.is_done:
            raise self._refused(self._peek()[1])

    def statement(self) -> Expression | Assignment:
        """Read an assignment or a value."""
        (kind, name), (_, sign) = self._peek(), self._peek(1)
        if kind == "name" and sign in _ASSIGNMENTS:
            self._next += 2
            value = self._level(0)
            known = _key(name)
            if len(sign) == 2 and sign != ":=":
                value = Binary(sign[0], known, value)
            return Assignment(known.name, value)
        return self._level(0)

    def _level(self, level: int) -> Expression:
        if level == len(_LEVELS):
            return self._unary()
        found, last = self._level(level + 1), None
        while self._peek()[0] == "sign" and self._peek()[1] in _LEVELS[level]:
            sign = _LEVELS[level][self._peek()[1]]
            self._next += 1
            right = self._level(level + 1)
            if level == _COMPARING and last is not None:
                found = Binary("and", found, Binary(sign, last, right))
            else:
                found = Binary(sign, found, right)
            last = right
        return found

    def _unary(self) -> Expression:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ScriptError(f"'{self._text[:40]}…' is nested more than {_DEEPEST} levels deep")
        for sign, op in (("-", "-"), ("!", "not")):
            if self.take(sign):
                found: Expression = Unary(op, self._unary())
                break
        else:
            found = self._atom()
        self._depth -= 1
        return found

    def _atom(self) -> Expression:
        if self.take("("):
            inner = self._level(0)
            if not self.take(")"):
                raise ScriptError(f"'{self._text}': a ')' is missing")
            return inner
        kind, token = self._peek()
        self._next += 1
        if kind == "number":
            return Number(self._number(token))
        if kind == "text":
            return Text(token[1:-1])
        if kind == "name":
            return Truth(token == "true") if token in ("true", "false") else _key(token)
        raise self._refused(token)

    def _number(self, token: str) -> float:
        is_whole = token.isdigit() or token[:2].lower() == "0x"
        if len(token) > _LONGEST_NUMBER or (not is_whole and not math.isfinite(float(token))):
            raise ScriptError(f"'{token[:40]}' is no number of a mission: it is too large")
        return int(token, 16 if token[1:2] in ("x", "X") else 10) if is_whole else float(token)

    def _refused(self, token: str) -> ScriptError:
        what = {
            "": "it ends too early",
            "?": "there is no choice with '?'; use if/then/else",
            "..": "texts are not joined with '..'",
        }
        return ScriptError(f"'{self._text}': {what.get(token, f'unexpected {token!r}')}")


def _key(name: str) -> Key:
    if _NAMES.fullmatch(name):
        return Key(name)
    cure = "; keys with @ are of the root's blackboard, which called trees do not see here"
    raise ScriptError(f"'{name}' is no key{cure if name.startswith('@') else ''}")
