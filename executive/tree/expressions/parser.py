"""Text to syntax tree, by operator precedence (Pratt 1973).

Units are known here, so that `3 m/s` is a speed and `3 m / {count}` a division.
"""

from executive.config import UNITS
from executive.errors import did_you_mean
from executive.tree.expressions.syntax import (
    BINDING,
    COMPARISONS,
    NEGATION,
    Binary,
    Expression,
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
from executive.tree.expressions.tokens import ExpressionError, Token, tokens

FUNCTIONS = ("len", "min", "max", "sum", "abs", "distance", "text", "has", "default")
OVERS = ("any", "all", "count", "only", "each")  # what is said about each item of a list
_LONGEST = 2000  # characters
_MOST = 100  # operators, functions and pairs of parentheses
_DEEPEST = 30
_WORDS = frozenset({"and", "or", "not", "in", "true", "false"})
UNIT_NAMES = tuple(unit for units in UNITS.values() for unit in units)


def parse(text: str) -> Expression:
    """Return the syntax tree of a text.

    Raises:
        ExpressionError: At the first mistake.
    """
    if len(text) > _LONGEST:
        raise ExpressionError(0, f"an expression has at most {_LONGEST} characters")
    parser = Parser(tokens(text))
    expression = parser.expression(0)
    parser.end()
    return expression


def is_quantity(text: str) -> bool:
    """Whether a text is a number with a unit, as `120 deg` is."""
    try:
        one = parse(text)
    except ExpressionError:
        return False
    one = one.of if isinstance(one, Unary) and one.op == "-" else one
    return isinstance(one, Number) and bool(one.unit)


def parse_path(text: str, start: int) -> tuple[Expression, int]:
    """Read a key in braces, with its fields, that begins at an offset of a text.

    Returns:
        The key, and the offset behind its closing brace.

    Raises:
        ExpressionError: At the first mistake.
    """
    end = text.find("}", start)
    if end < 0:
        raise ExpressionError(start, "this brace is not closed; a brace as text is written '{{'")
    parser = Parser(tokens(text[: end + 1], start))
    path = parser.expression(0)
    parser.end()
    return path, end + 1


class Parser:
    """Reads one expression from its words."""

    def __init__(self, words: list[Token]) -> None:
        self._words = [*words, words[-1], words[-1]]  # as far as it is looked ahead
        self._next = 0
        self._count = 0
        self._depth = 0

    def expression(self, strength: int) -> Expression:
        """Read operators that bind at least so strongly, and what they join."""
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ExpressionError(self._peek().at, f"nested more than {_DEEPEST} levels deep")
        left, compared = self._prefix(), None
        while (op := self._operator()) is not None and BINDING[op] >= strength:
            word = self._take()
            if op == "not in":
                self._take()
            if op in COMPARISONS and compared is not None:
                cure = f"write '{left} and {compared.right} {op} …'"
                raise ExpressionError(word.at, f"comparisons are not chained; {cure}")
            self._step(word)
            left = joined = Binary(op, left, self.expression(BINDING[op] + 1), word.at)
            compared = joined if op in COMPARISONS else None
        self._depth -= 1
        return left

    def end(self) -> None:
        """Refuse what is left.

        Raises:
            ExpressionError: If anything is left.
        """
        word = self._peek()
        if word.kind != "end":
            raise ExpressionError(word.at, _unexpected(word, "an operator such as + or and"))

    # --- words

    def _peek(self, ahead: int = 0) -> Token:
        return self._words[self._next + ahead]

    def _take(self) -> Token:
        word = self._words[self._next]
        if word.kind != "end":
            self._next += 1
        return word

    def _is(self, letters: str, ahead: int = 0) -> bool:
        word = self._words[self._next + ahead]
        return word.letters == letters and word.kind in ("sign", "name")

    def _expect(self, letters: str) -> Token:
        if not self._is(letters):
            raise ExpressionError(self._peek().at, _unexpected(self._peek(), f"'{letters}'"))
        return self._take()

    def _name(self, what: str) -> Token:
        word = self._peek()
        if word.kind != "name":
            raise ExpressionError(word.at, _unexpected(word, what))
        return self._take()

    def _step(self, word: Token) -> None:
        self._count += 1
        if self._count > _MOST:
            raise ExpressionError(
                word.at, f"more than {_MOST} operations; compute a part with 'set' before"
            )

    def _operator(self) -> str | None:
        word = self._peek()
        if word.kind not in ("sign", "name"):
            return None
        if word.letters == "not" and self._is("in", 1):
            return "not in"
        return word.letters if word.letters in BINDING and word.letters != "not" else None

    # --- values

    def _prefix(self) -> Expression:
        word = self._peek()
        if self._is("not"):
            self._step(self._take())
            return Unary("not", self.expression(BINDING["not"]), word.at)
        if self._is("-"):
            self._step(self._take())
            return Unary("-", self.expression(NEGATION), word.at)
        return self._postfix(self._primary())

    def _postfix(self, one: Expression) -> Expression:
        while True:
            if self._is("."):
                self._step(self._take())
                name = self._name("the name of a field")
                one = Field(one, name.letters, name.at)
            elif self._is("["):
                word = self._take()
                self._step(word)
                one = Index(one, self.expression(0), word.at)
                self._expect("]")
            else:
                return one

    def _primary(self) -> Expression:
        word = self._take()
        if word.kind == "number":
            return self._number(word)
        if word.kind == "text":
            return Text(word.letters[1:-1], word.at)
        if word.kind == "name" and word.letters in ("true", "false"):
            return Truth(word.letters == "true", word.at)
        if word.kind == "name" and word.letters not in _WORDS:
            return self._function(word)
        if word.kind == "sign" and word.letters == "{":
            return self._key()
        if word.kind == "sign" and word.letters == "(":
            self._step(word)
            inner = self.expression(0)
            self._expect(")")
            return inner
        if word.kind == "sign" and word.letters == "[":
            self._step(word)
            return Listed(self._several("]"), word.at)
        raise ExpressionError(word.at, _unexpected(word, "a value"))

    def _key(self) -> Expression:
        name = self._name("the name of a key")
        one: Expression = Key(name.letters, name.at)
        while not self._is("}"):
            if self._is("."):
                self._take()
                field = self._name("the name of a field")
                one = Field(one, field.letters, field.at)
            elif self._is("["):
                place = self._take()
                index = self._take()
                if index.kind != "number" or not index.letters.isdigit():
                    raise ExpressionError(index.at, _unexpected(index, "the number of an item"))
                one = Index(one, Number(int(index.letters), "", index.at), place.at)
                self._expect("]")
            else:
                word = self._peek()
                raise ExpressionError(word.at, _unexpected(word, "'}'"))
            self._step(self._peek())
        self._take()
        return one

    def _number(self, word: Token) -> Number:
        letters = word.letters
        value = int(letters) if letters.isdigit() and len(letters) < 300 else float(letters)
        if value in (float("inf"), float("-inf")):
            raise ExpressionError(word.at, "this number is too large")
        return Number(value, self._unit(), word.at)

    def _unit(self) -> str:
        word = self._peek()
        if word.kind != "name" or word.letters in _WORDS:
            return ""
        compound = self._peek(1), self._peek(2)
        joined = f"{word.letters}/{compound[1].letters}"
        if self._is("/", 1) and compound[1].kind == "name" and joined in UNIT_NAMES:
            self._next += 3
            return joined
        if word.letters not in UNIT_NAMES:
            near = did_you_mean(word.letters, UNIT_NAMES)
            raise ExpressionError(word.at, f"'{word.letters}' is not a unit{near}")
        self._take()
        return word.letters

    def _function(self, word: Token) -> Expression:
        known = (*FUNCTIONS, *OVERS)
        if not self._is("("):
            if word.letters in known:
                cure = f"a function is written '{word.letters}(…)'"
            else:
                cure = f"a key stands in braces, {{{word.letters}}}, and a text in quotes"
            raise ExpressionError(word.at, f"'{word.letters}' is no value; {cure}")
        if word.letters not in known:
            near = did_you_mean(word.letters, known)
            raise ExpressionError(word.at, f"no function '{word.letters}'{near}")
        self._step(self._take())
        if word.letters in OVERS:
            return self._over(word)
        return Function(word.letters, self._several(")"), word.at)

    def _over(self, word: Token) -> Expression:
        if self._peek().kind != "name" or not self._is("in", 1):
            form = f"{word.letters}(one in {{list}}: {{one}} …)"
            raise ExpressionError(self._peek().at, f"'{word.letters}' is written '{form}'")
        item = self._take().letters
        self._take()
        source = self.expression(0)
        self._expect(":")
        body = self.expression(0)
        self._expect(")")
        return Over(word.letters, item, source, body, word.at)

    def _several(self, closing: str) -> tuple[Expression, ...]:
        items: list[Expression] = []
        while not self._is(closing):
            items.append(self.expression(0))
            if not self._is(closing):
                self._expect(",")
        self._take()
        return tuple(items)


def _unexpected(word: Token, wanted: str) -> str:
    if word.kind == "end":
        return f"the expression ends where {wanted} is expected"
    return f"expected {wanted}, got '{word.letters}'"
