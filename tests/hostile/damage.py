"""Damage to the content of a file: flipped bits, cuts, insertions, and numbers out of all range."""

import re
import struct
from collections.abc import Callable

import numpy as np

_HEADER = 400  # bytes in which most formats state sizes and places
_NUMBER = re.compile(rb"[-+]?\d+(\.\d+)?([eE][-+]?\d+)?")
_WORDS = (
    b"-1", b"0", b"nan", b"-inf", b".inf", b"1e999", b"1e308", b"4294967295", b"9" * 20,
    b"9" * 400, b"-0", b"0x7fffffff", b"", b"true", b"null", b"1e-320", b"3.7", b"[1]", b'"x"',
)  # fmt: skip
_TEXT = (
    b"\n", b"\t", b"{", b"}", b"[", b"]", b'"', b"'", b": ", b"- ", b"&a ", b"*a", b"!!x ", b"<a>",
    b"</a>", b"\x00", b"\xff", b"\xc3\xa4", b"\xf0\x9f\xaa\xa8", b"\\", b"%", b"#", b"\r", b" ",
    b",", b"/", b"..",
)  # fmt: skip
_VALUES = {
    "b": (-1, -128, 127, 0),
    "h": (-1, -(2**15), 2**15 - 1, 0),
    "i": (-1, -(2**31), 2**31 - 1, 0, 1),
    "q": (-1, -(2**63), 2**63 - 1, 0, 24_000_000_000),
    "f": (float("nan"), float("inf"), -1.0, 3e38),
    "d": (float("nan"), float("-inf"), 1e300, -1.0, 5e-324),
}
_NUMBERS = tuple(
    struct.pack(order + form, value)
    for order in "<>"
    for form, values in _VALUES.items()
    for value in values
)


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """Return content with one to four changes, one in half of all cases."""
    for _ in range(min(4, int(rng.geometric(0.5)))):
        content = _CHANGES[rng.integers(len(_CHANGES))](content, rng)
    return content


def _place(content: bytes, rng: np.random.Generator) -> int:
    """Return a byte, in the header or the tail in every second case."""
    size = max(1, len(content))
    where = rng.integers(4)
    if where == 0:
        return int(rng.integers(min(_HEADER, size)))
    if where == 1:
        return int(size - 1 - rng.integers(min(_HEADER, size)))
    return int(rng.integers(size))


def _span(rng: np.random.Generator) -> int:
    return int(2 ** rng.uniform(0, 10))


def _flip(content: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 9))):
        if changed:
            changed[_place(content, rng)] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def _cut(content: bytes, rng: np.random.Generator) -> bytes:
    return content[: _place(content, rng)]


def _insert(content: bytes, rng: np.random.Generator) -> bytes:
    at, length = _place(content, rng), _span(rng)
    if rng.integers(2):
        piece = rng.bytes(length)
    else:
        start = _place(content, rng)
        piece = content[start : start + length] * int(rng.integers(1, 4))
    return content[:at] + piece + content[at:]


def _delete(content: bytes, rng: np.random.Generator) -> bytes:
    at = _place(content, rng)
    return content[:at] + content[at + _span(rng) :]


def _number(content: bytes, rng: np.random.Generator) -> bytes:
    """Overwrite bytes with a binary number."""
    at, number = _place(content, rng), _NUMBERS[rng.integers(len(_NUMBERS))]
    return content[:at] + number + content[at + len(number) :]


def _written_number(content: bytes, rng: np.random.Generator) -> bytes:
    """Replace a number that is written in digits."""
    at = _place(content, rng)
    found = _NUMBER.search(content, at, at + 4096)
    word = _WORDS[rng.integers(len(_WORDS))]
    return content[: found.start()] + word + content[found.end() :] if found else content


def _sign(content: bytes, rng: np.random.Generator) -> bytes:
    at = _place(content, rng)
    return (
        content[:at] + _TEXT[rng.integers(len(_TEXT))] * int(2 ** rng.uniform(0, 7)) + content[at:]
    )


_CHANGES: tuple[Callable[[bytes, np.random.Generator], bytes], ...] = (
    _flip, _flip, _cut, _insert, _delete, _number, _number, _written_number, _written_number, _sign,
)  # fmt: skip
