"""Coordinates from lines of numbers: XYZ files and the text forms of PLY and PCD."""

import re
from collections.abc import Iterator, Mapping, Sequence
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
    columns: Mapping[str, int],
    most: int,
    collector: PointCollector,
) -> int:
    """Add the points of lines of text to a collector and return how many there were.

    Blank lines and everything after `#` or `//` are skipped. Numbers are separated by commas,
    semicolons, blanks or tabs.

    Args:
        path: The file.
        start: Byte at which the first line begins.
        first_line: Number of that line, for messages.
        columns: Indices of x, y, z and the carried fields among the numbers of a line, from 0, by
            name.
        most: Lines after this many points are not read.
        collector: Receives the points.

    Raises:
        DataError: If a line lacks one of the numbers; the message names the line.
    """
    found = 0
    for number, block, is_last in _blocks(path, start, first_line):
        lines = _content(block)
        rows = [(number + i, line) for i, line in enumerate(lines) if line][: most - found]
        if not rows:
            continue
        table = _parse(path, rows, tuple(columns.values()), is_last)
        fields = dict(zip(columns, table.T, strict=True))
        collector.add(fields["x"], fields["y"], fields["z"], fields)
        found += len(table)
        if found == most:
            break
    return found


def count_lines(path: Path) -> int:
    """Return the number of lines of a file, including a last one without a line break."""
    with path.open("rb") as file:
        return 1 + sum(block.count(b"\n") for block in iter(lambda: file.read(_BLOCK), b""))


def _blocks(path: Path, start: int, number: int) -> Iterator[tuple[int, str, bool]]:
    """Yield the text in blocks of whole lines.

    Yields:
        Number of the block's first line, the block, and whether it is a last line that no line
        break ends.
    """
    rest = b""
    with path.open("rb") as file:
        file.seek(start)
        while piece := file.read(_BLOCK):
            whole, end, rest = (rest + piece).rpartition(b"\n")
            if len(rest) > _LONGEST_LINE or b"\0" in piece:
                raise DataError(
                    f"{path}: not lines of numbers, but binary or UTF-16; export it "
                    "again, as plain text"
                )
            yield number, whole.decode("utf-8", errors="replace"), False
            number += whole.count(b"\n") + len(end)
        yield number, rest.decode("utf-8", errors="replace"), True


def _content(block: str) -> list[str]:
    """Return the lines without comments and byte-order mark; separators are still in them."""
    if "#" in block or "//" in block:
        block = re.sub(r"(#|//)[^\n]*", "", block)
    return [line.strip() for line in block.lstrip("\ufeff").split("\n")]


def _parse(
    path: Path, rows: Sequence[tuple[int, str]], columns: Sequence[int], is_last: bool
) -> Float:
    """Return the numbers of the wanted columns, a column each."""
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
