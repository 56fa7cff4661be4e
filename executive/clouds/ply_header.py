"""The header of a PLY file, held against the file's size."""

from dataclasses import dataclass, field
from pathlib import Path

from executive.errors import DataError

_BYTES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2,
    "int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip
_LONGEST_HEADER = 1 << 16


@dataclass(slots=True)
class _Element:
    name: str
    count: int
    sizes: dict[str, int] = field(default_factory=dict)  # bytes by property


def check_ply(path: Path) -> None:
    """Refuse a PLY file without coordinates, or shorter than its header says.

    Raises:
        DataError: It names the file, what is wrong and the cure.
    """
    text, start = _header(path)
    form, elements = _parse(path, text)
    vertex = next((element for element in elements if element.name == "vertex"), None)
    if vertex is None or not {"x", "y", "z"} <= set(vertex.sizes):
        raise DataError(f"{path}: the header names no vertices with x, y and z; export it as a point cloud")
    # A list's length is not in the header: what follows the points counts as nothing, and this is a lower bound.
    needed = elements[: elements.index(vertex) + 1]
    if form == "ascii":
        have, what = _numbers(path, start), "numbers"
        want = sum(element.count * len(element.sizes) for element in needed)
    else:
        have, what = path.stat().st_size - start, "bytes"
        want = sum(element.count * sum(element.sizes.values()) for element in needed)
    if have < want:
        raise DataError(
            f"{path}: cut short: the header promises {vertex.count} points ({want} {what}), the file has {have} {what}"
            "; copy or export it again"
        )


def _numbers(path: Path, start: int) -> int:
    """Count words line by line: all of them at once would take many times the file's size."""
    with path.open("rb") as file:
        file.seek(start)
        return sum(len(line.split()) for line in file)


def _header(path: Path) -> tuple[str, int]:
    with path.open("rb") as file:
        beginning = file.read(_LONGEST_HEADER)
    end = beginning.find(b"end_header")
    stop = beginning.find(b"\n", end)
    if not beginning.startswith(b"ply") or end < 0 or stop < 0:
        raise DataError(f"{path}: no PLY file: it lacks a header from 'ply' to 'end_header'; export it again")
    return beginning[:end].decode("ascii", errors="replace"), stop + 1


def _parse(path: Path, text: str) -> tuple[str, list[_Element]]:
    form, elements = "", list[_Element]()
    try:
        for words in (line.split() for line in text.splitlines()):
            if words[:1] == ["format"]:
                form = words[1]
            elif words[:1] == ["element"]:
                elements.append(_Element(words[1], int(words[2])))
            elif words[:1] == ["property"] and words[1] != "list":
                elements[-1].sizes[words[2]] = _BYTES[words[1]]
    except (IndexError, ValueError, KeyError) as error:
        raise DataError(f"{path}: the PLY header cannot be understood ({error}); export it again") from error
    return form, elements
