"""Plain YAML scalars by the core schema of YAML 1.2; what YAML 1.1 reads otherwise is refused."""

import re

from executive.tree.problem import shortened

Plain = str | int | float | bool | None

_NULL = frozenset({"", "~", "null", "Null", "NULL"})
_BOOL = {
    word: value
    for value in (True, False)
    for word in (f"{value}".lower(), f"{value}", f"{value}".upper())
}
_INT = re.compile(r"[-+]?\d+")
_BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.\d+|\d+(?:\.\d*)?)(?:[eE][-+]?\d+)?")
_SPECIAL = {
    f"{sign}.{word}": float(f"{sign}{word}")
    for sign in ("", "+", "-")
    for word in ("inf", "Inf", "INF")
}
_NAN = frozenset({".nan", ".NaN", ".NAN"})
_LONGEST_INT = (
    300  # digits; Python refuses to convert more than a few thousand, and no quantity has so many
)

# What YAML 1.1 reads as something else than text or another number: (pattern, what to write
# instead).
_SURPRISES = (
    (re.compile(r"(?i:yes|on)"), "is true in YAML 1.1 and text in 1.2: write true, or quote it"),
    (re.compile(r"(?i:no|off)"), "is false in YAML 1.1 and text in 1.2: write false, or quote it"),
    (re.compile(r"[-+]?0\d+(?:_|\d)*"), "is octal in YAML 1.1, decimal in 1.2: drop the leading "
"zero, "
"or "
"quote "
"it"),
    (re.compile(r"[-+]?\d+(?::[0-5]?\d)+(?:\.\d*)?"), "is to base 60 in YAML 1.1: write a unit (30 "
"min), "
"or "
"quote "
"it"),
    (re.compile(r"\d{4}-\d\d?-\d\d?(?:[Tt ].*)?"), "is a date in YAML 1.1: quote it"),
    (re.compile(r"[-+]?0b[01_]+"), "is a binary number in YAML 1.1: write it as decimal or 0x…, or "
"quote "
"it"),
    (re.compile(r"[-+]?(?:\d[\d_]*_[\d_]*(?:\.[\d_]*)?|0x[0-9a-fA-F]*_[0-9a-fA-F_]*)"),
     "is a number in YAML 1.1 and text in 1.2: leave the underscores out, or quote it"),
)  # fmt: skip


# How a text begins that is anything else than text, or that is read differently.
_FIRST = frozenset("-+.0123456789yYnNoO")


class SurpriseError(ValueError):
    """A plain scalar that two versions of YAML read differently."""


def resolve(text: str) -> Plain:
    """Return the value of a plain (unquoted) scalar.

    Raises:
        SurpriseError: If another version of YAML would read it differently; the message says what
            to write.
    """
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if text[0] not in _FIRST:
        return text
    for pattern, cure in _SURPRISES:
        if pattern.fullmatch(text):
            raise SurpriseError(f"{shortened(repr(text), 40)} {cure}")
    if text in _SPECIAL:
        return _SPECIAL[text]
    return float("nan") if text in _NAN else _number(text)


def _number(text: str) -> Plain:
    if len(text) > _LONGEST_INT:
        return text
    if _INT.fullmatch(text):
        return int(text)
    if _BASED.fullmatch(text):
        return int(text, 0)
    return float(text) if _FLOAT.fullmatch(text) else text
