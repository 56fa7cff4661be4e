"""The header of a PLY file, checked against the file's size."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from executive.errors import DataError

_CODES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4",
    "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_HEADER = 1 << 16


@dataclass(slots=True)
class _Element:
    name: str
    count: int
    fields: list[tuple[str, str]] = field(default_factory=list)  # name and numpy's code
    has_list: bool = False


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """Where the points of a PLY file are.

    Attributes:
        is_text: Whether rows are lines of text.
        count: Number of points.
        row: Fields of a point.
        start: Byte at which the body of a text file or the points of a binary file begin.
        skipped_lines: Number of lines of the body before the points of a text file.
        lines: Number of lines of the header.
    """

    is_text: bool
    count: int
    row: np.dtype
    start: int
    skipped_lines: int
    lines: int


def read_ply_header(path: Path) -> PlyHeader:
    """Read the header, and refuse a file without coordinates or shorter than its header says.

    Raises:
        DataError: If the header cannot be parsed, lacks x, y or z, or promises more points than
            the file can hold.
    """
    text, start = _header(path)
    form, elements = _parse(path, text)
    vertex = next((element for element in elements if element.name == "vertex"), None)
    if vertex is None or not {"x", "y", "z"} <= {name for name, _ in vertex.fields}:
        raise DataError(
            f"{path}: the header names no vertices with x, y and z; export it as a point cloud"
        )
    before = elements[: elements.index(vertex)]
    is_text = form == "ascii"
    if vertex.has_list or (not is_text and any(element.has_list for element in before)):
        raise DataError(
            f"{path}: has lists in its vertices or before them; export it as a point cloud"
        )
    row = np.dtype([(name, _ORDERS[form] + code) for name, code in vertex.fields])
    skipped = (
        0
        if is_text
        else sum(e.count * sum(np.dtype(code).itemsize for _, code in e.fields) for e in before)
    )
    header = PlyHeader(
        is_text,
        vertex.count,
        row,
        start + skipped,
        sum(e.count for e in before),
        text.count("\n") + 1,
    )
    # The shortest line of n numbers takes 2n bytes; elements after the points are not counted.
    least = vertex.count * (2 * len(vertex.fields) if is_text else row.itemsize) - is_text
    if path.stat().st_size - header.start < least:
        raise DataError(
            f"{path}: cut short: the header promises {vertex.count} points (at least "
            f"{least} bytes), the file has "
            f"{max(0, path.stat().st_size - header.start)} bytes; copy or export it again"
        )
    return header


def _header(path: Path) -> tuple[str, int]:
    with path.open("rb") as file:
        beginning = file.read(_LONGEST_HEADER)
    end = beginning.find(b"end_header")
    stop = beginning.find(b"\n", end)
    if not beginning.startswith(b"ply") or end < 0 or stop < 0:
        raise DataError(
            f"{path}: not a PLY file: it lacks a header from 'ply' to 'end_header'; export it again"
        )
    return beginning[:end].decode("ascii", errors="replace"), stop + 1


def _parse(path: Path, text: str) -> tuple[str, list[_Element]]:
    form, elements = "", list[_Element]()
    try:
        for words in (line.split() for line in text.splitlines()):
            if words[:1] == ["format"]:
                form = words[1]
            elif words[:1] == ["element"]:
                elements.append(_Element(words[1], int(words[2])))
            elif words[:2] == ["property", "list"]:
                elements[-1].has_list = True
            elif words[:1] == ["property"]:
                elements[-1].fields.append((words[2], _CODES[words[1]]))
        if form not in _ORDERS or any(element.count < 0 for element in elements):
            raise ValueError(
                f"format '{form}'" if form not in _ORDERS else "a negative number of elements"
            )
        for element in elements:
            np.dtype(element.fields)  # raises ValueError if a name occurs twice
    except (IndexError, ValueError, KeyError) as error:
        raise DataError(
            f"{path}: the PLY header cannot be parsed ({error}); export it again"
        ) from error
    return form, elements
