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
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_HEADER = 1 << 16
_MOST_ROWS = 1 << 48  # no file is larger


@dataclass(slots=True)
class PlyElement:
    """A kind of rows, such as `vertex` or `face`.

    Attributes:
        name: Its name.
        count: Number of rows.
        fields: Name and NumPy's type of each number of a row; of a list, that of its items.
        lengths: NumPy's type of the length of a list, by the list's name.
    """

    name: str
    count: int
    fields: list[tuple[str, str]] = field(default_factory=list)
    lengths: dict[str, str] = field(default_factory=dict)

    @property
    def has_list(self) -> bool:
        """Whether rows differ in length."""
        return bool(self.lengths)


@dataclass(frozen=True, slots=True)
class PlyLayout:
    """What the header says: the elements in the order of the file.

    Attributes:
        order: NumPy's sign of the byte order; empty for text.
        elements: The elements.
        start: Byte at which the first row begins.
        lines: Number of lines of the header.
    """

    order: str
    elements: list[PlyElement]
    start: int
    lines: int


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
    layout = read_ply_layout(path)
    elements = layout.elements
    vertex = next((element for element in elements if element.name == "vertex"), None)
    if vertex is None or not {"x", "y", "z"} <= {name for name, _ in vertex.fields}:
        raise DataError(
            f"{path}: the header names no vertices with x, y and z; export it as a point cloud"
        )
    before = elements[: elements.index(vertex)]
    is_text = not layout.order
    if vertex.has_list or (not is_text and any(element.has_list for element in before)):
        raise DataError(
            f"{path}: has lists in its vertices or before them; export it as a point cloud"
        )
    row = np.dtype([(name, (layout.order or "=") + code) for name, code in vertex.fields])
    skipped = (
        0
        if is_text
        else sum(e.count * sum(np.dtype(code).itemsize for _, code in e.fields) for e in before)
    )
    header = PlyHeader(
        is_text,
        vertex.count,
        row,
        layout.start + skipped,
        sum(e.count for e in before),
        layout.lines,
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


def read_ply_layout(path: Path) -> PlyLayout:
    """Read the header.

    Raises:
        DataError: If it cannot be parsed.
    """
    text, start = _header(path)
    form, elements = _parse(path, text)
    return PlyLayout(_ORDERS[form], elements, start, text.count("\n") + 1)


def _header(path: Path) -> tuple[str, int]:
    with path.open("rb") as file:
        beginning = file.read(_LONGEST_HEADER)
    end = beginning.find(b"end_header")
    stop = beginning.find(b"\n", end)
    is_whole = end >= 0 and stop >= 0
    if beginning.startswith(b"ply") and not is_whole and len(beginning) == _LONGEST_HEADER:
        raise DataError(
            f"{path}: its header does not end within {_LONGEST_HEADER:,} bytes; export it again "
            "without long comments"
        )
    if not beginning.startswith(b"ply") or not is_whole:
        raise DataError(
            f"{path}: not a PLY file: it lacks a header from 'ply' to 'end_header'; export it again"
        )
    return beginning[:end].decode("ascii", errors="replace"), stop + 1


def _parse(path: Path, text: str) -> tuple[str, list[PlyElement]]:
    form, elements = "", list[PlyElement]()
    try:
        for words in (line.split() for line in text.splitlines()):
            if words[:1] == ["format"]:
                form = words[1]
            elif words[:1] == ["element"]:
                elements.append(PlyElement(words[1], int(words[2])))
            elif words[:2] == ["property", "list"]:
                elements[-1].lengths[words[4]] = _length(words[2])
                elements[-1].fields.append((words[4], _CODES[words[3]]))
            elif words[:1] == ["property"]:
                elements[-1].fields.append((words[2], _CODES[words[1]]))
        if form not in _ORDERS:
            raise ValueError(f"format '{form}'")
        for element in elements:
            if not 0 <= element.count <= _MOST_ROWS:
                raise ValueError(f"a number of {element.name} that no file can hold")
            np.dtype(element.fields)  # raises ValueError if a name occurs twice
    except (IndexError, ValueError, KeyError) as error:
        raise DataError(
            f"{path}: the PLY header cannot be parsed ({error}); export it again"
        ) from error
    return form, elements


def _length(kind: str) -> str:
    code = _CODES[kind]
    if code.startswith("f"):
        raise ValueError(f"the length of a list is of type {kind}")
    return code
