"""Coordinates from lines of numbers, the same for XYZ files and the text forms of PLY and PCD."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.clouds.point_collector import PointCollector
from executive.errors import DataError

_BLOCK = 1 << 22  # bytes read at a time
_LONGEST_LINE = 1 << 16
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)
_DECIMAL_COMMAS = re.compile(r"[+-]?\d+,\d+([;\s]+[+-]?\d+,\d+){2}")


def collect_lines(
    path: Path,
    start: int,
    first_line: int,
    columns: Sequence[int],
    most: int,
    collector: PointCollector,
) -> int:
    """Add the points of at most so many lines from a byte on and return how many there were.

    Blank lines and what follows `#` or `//` are skipped; commas, semicolons, blanks and tabs
    separate.

    Args:
        path: The file.
        start: Where the first line begins.
        first_line: Its number, for messages.
        columns: Where x, y and z stand in a line, from 0.
        most: Lines after this many points are left alone.
        collector: What takes the points.

    Raises:
        DataError: If a line does not begin with as many numbers; it is named.
    """
    found = 0
    for number, block, is_last in _blocks(path, start, first_line):
        lines = _content(block)
        rows = [(number + i, line) for i, line in enumerate(lines) if line][: most - found]
        if not rows:
            continue
        points = _parse(path, rows, columns, is_last)
        collector.add(points[:, 0], points[:, 1], points[:, 2])
        found += len(points)
        if found == most:
            break
    return found


def count_lines(path: Path) -> int:
    """Return how many lines a file has, a last one without an end included."""
    with path.open("rb") as file:
        return 1 + sum(block.count(b"\n") for block in iter(lambda: file.read(_BLOCK), b""))


def _blocks(path: Path, start: int, number: int) -> Iterator[tuple[int, str, bool]]:
    """Give the text in blocks of whole lines, with the number of the first and whether it is a last
    one without end.
    """
    rest = b""
    with path.open("rb") as file:
        file.seek(start)
        while piece := file.read(_BLOCK):
            whole, end, rest = (rest + piece).rpartition(b"\n")
            if len(rest) > _LONGEST_LINE or b"\0" in piece:
                raise DataError(
                    f"{path}: no text of numbers, but binary or UTF-16; export it "
                    "again, as plain text"
                )
            yield number, whole.decode("utf-8", errors="replace"), False
            number += whole.count(b"\n") + len(end)
        yield number, rest.decode("utf-8", errors="replace"), True


def _content(block: str) -> list[str]:
    """Return the lines without comments and byte-order mark, not yet without separators."""
    if "#" in block or "//" in block:
        block = re.sub(r"(#|//)[^\n]*", "", block)
    return [line.strip() for line in block.lstrip("\ufeff").split("\n")]


def _parse(
    path: Path, rows: Sequence[tuple[int, str]], columns: Sequence[int], is_last: bool
) -> Float:
    """Return the numbers of the wanted columns, shape (N, 3)."""
    if any("," in line or ";" in line for _, line in rows):
        for number, line in rows:
            if _DECIMAL_COMMAS.match(line):
                raise DataError(
                    f"{path}:{number}: '{line[:40]}' has decimal commas; export it with "
                    "decimal points"
                )
        rows = [(number, line.replace(",", " ").replace(";", " ")) for number, line in rows]
    try:
        return np.loadtxt([line for _, line in rows], usecols=columns, comments=None, ndmin=2)
    except ValueError:
        raise _first_bad_line(path, rows, columns, is_last) from None


def _first_bad_line(
    path: Path, rows: Sequence[tuple[int, str]], columns: Sequence[int], is_last: bool
) -> DataError:
    for number, line in rows:
        words = line.split()
        if len(words) <= max(columns) or not all(_NUMBER.fullmatch(words[i]) for i in columns):
            if is_last:
                return DataError(
                    f"{path}: cut short: ends in line {number}, '{line[:40]}'; copy or "
                    "export it again"
                )
            return DataError(f"{path}:{number}: expected x y z, got '{line[:40]}'; repair the line")
    return DataError(f"{path}: its lines cannot be read as numbers; export it again")
