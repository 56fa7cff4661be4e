"""The header of a PCD file."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from executive.errors import DataError

_LONGEST_HEADER = 1 << 14
_MOST_POINTS = 1 << 48  # no file is larger
_KINDS = {"F": "f", "I": "i", "U": "u"}
_FORMS = ("ascii", "binary", "binary_compressed")


@dataclass(frozen=True, slots=True)
class PcdHeader:
    """Where the points of a PCD file are.

    Attributes:
        form: `ascii`, `binary` or `binary_compressed`.
        count: Number of points.
        row: Fields of a point; a field of several values has a shape. Fields of one name, as that
            of padding, have numbers for names.
        start: Byte at which the points begin.
        lines: Lines of the header.
    """

    form: str
    count: int
    row: np.dtype
    start: int
    lines: int

    def columns(self, names: Sequence[str]) -> dict[str, int]:
        """Return the indices of fields among the numbers of a line of a text file, by name."""
        widths = [int(np.prod(self.row[name].shape)) for name in self.row.names or ()]
        starts = dict(zip(self.row.names or (), np.cumsum([0, *widths]).tolist(), strict=False))
        return {name: starts[name] for name in names}

    def offset(self, name: str) -> int:
        """Return at which byte of a point a field begins."""
        fields = self.row.fields
        return int(fields[name][1]) if fields else 0

    @property
    def columns_of_a_line(self) -> int:
        """Number of numbers in a line of a text file."""
        return sum(int(np.prod(self.row[name].shape)) for name in self.row.names or ())


def read_pcd_header(path: Path) -> PcdHeader:
    """Read the header and refuse a file without coordinates.

    Raises:
        DataError: If the header is no PCD header, or lacks x, y or z.
    """
    fields, start, lines = _fields(path)
    if not {"x", "y", "z"} <= set(fields["FIELDS"]):
        raise DataError(
            f"{path}: the header names no fields x, y and z; export it as a point cloud"
        )
    try:
        return PcdHeader(_form(fields), int(fields["POINTS"][0]), _row(fields), start, lines)
    except (IndexError, ValueError, KeyError, TypeError) as error:
        raise DataError(
            f"{path}: the PCD header cannot be parsed ({error}); export it again"
        ) from error


def _form(fields: dict[str, list[str]]) -> str:
    form, points = fields["DATA"][0], int(fields["POINTS"][0])
    if form not in _FORMS:
        raise ValueError(f"unknown DATA {form}")
    if not 0 <= points <= _MOST_POINTS:
        raise ValueError("a number of points that no file can hold")
    if {"WIDTH", "HEIGHT"} <= set(fields) and int(fields["WIDTH"][0]) * int(
        fields["HEIGHT"][0]
    ) != points:
        raise ValueError(f"WIDTH times HEIGHT is not {points}")
    return form


def _row(fields: dict[str, list[str]]) -> np.dtype:
    names = fields["FIELDS"]
    kinds = fields.get("TYPE", ["F"] * len(names))
    counts = [int(count) for count in fields.get("COUNT", ["1"] * len(names))]
    described, times = [], Counter(names)
    for i, (name, kind, size, count) in enumerate(
        zip(names, kinds, fields["SIZE"], counts, strict=True)
    ):
        if count < 1 or (name in ("x", "y", "z") and count != 1):
            raise ValueError(f"field {name} has {count} values")
        is_one = name in ("x", "y", "z") or times[name] == 1
        unique = name if is_one else f"{i}"  # padding fields share the name _
        described.append(
            (unique, f"<{_KINDS[kind]}{size}", (count,))
            if count > 1
            else (unique, f"<{_KINDS[kind]}{size}")
        )
    return np.dtype(described)


def _fields(path: Path) -> tuple[dict[str, list[str]], int, int]:
    with path.open("rb") as file:
        beginning = file.read(_LONGEST_HEADER)
    start = beginning.find(b"\nDATA ")
    stop = beginning.find(b"\n", start + 1)
    lines = beginning[:stop].decode("ascii", errors="replace").splitlines()
    fields = {
        words[0]: words[1:]
        for line in lines
        if (words := line.split()) and not words[0].startswith("#")
    }
    if start < 0 or stop < 0 or not {"FIELDS", "SIZE", "POINTS", "DATA"} <= set(fields):
        raise DataError(
            f"{path}: not a PCD file: it lacks a header with FIELDS, SIZE, POINTS and "
            "DATA; export it again"
        )
    return fields, stop + 1, len(lines)
