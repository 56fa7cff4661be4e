"""Triangles from PLY files, text or binary of either byte order."""

import struct
from array import array
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.meshes.damage import MeshDamageError
from executive.clouds.meshes.triangle_collector import TriangleCollector, fans
from executive.clouds.ply_header import PlyElement, PlyLayout, read_ply_layout

_CORNERS = ("vertex_indices", "vertex_index")
_LETTERS = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}


def read_ply_mesh(path: Path) -> tuple[Float, Int]:
    """Return vertices, shape (N, 3), and the indices of triangles' corners, shape (M, 3).

    Raises:
        DataError: If the header cannot be parsed.
        MeshDamageError: If rows are missing or are not what the header says.
    """
    layout = read_ply_layout(path)
    vertices, triangles = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    with path.open("rb") as file:
        file.seek(layout.start)
        room = path.stat().st_size - layout.start
        for element in layout.elements:
            _check_room(element, room)
            if element.name == "vertex":
                vertices = _vertices(file, layout, element)
            elif element.name == "face":
                triangles = _faces(file, layout, element)
            else:
                deque(_rows(file, layout, element), maxlen=0)
    return vertices, triangles


def _check_room(element: PlyElement, room: int) -> None:
    """Check that a file with so many bytes can hold the rows: a number takes at least a byte."""
    if element.count * max(1, len(element.fields)) > room:
        raise MeshDamageError(f"it promises {element.count} {element.name} rows in {room} bytes")


def _vertices(file: IO[bytes], layout: PlyLayout, element: PlyElement) -> Float:
    names = [name for name, _ in element.fields]
    if element.has_list or not {"x", "y", "z"} <= set(names):
        raise MeshDamageError("its vertices have no x, y and z, or lists beside them")
    if not layout.order:
        columns = [names.index(axis) for axis in "xyz"]
        flat = array("d")
        for words in _lines(file, element):
            flat.extend([float(words[i]) for i in columns])
        return np.array(flat, dtype=float).reshape(-1, 3)
    numbers = _plain(file, layout, element)
    return np.column_stack([numbers[axis].astype(float) for axis in "xyz"])


def _faces(file: IO[bytes], layout: PlyLayout, element: PlyElement) -> Int:
    name = next((one for one in _CORNERS if one in element.lengths), None)
    if name is None or dict(element.fields)[name].startswith("f"):
        raise MeshDamageError(f"its faces have no list '{_CORNERS[0]}' of whole numbers")
    if layout.order and element.count:
        corners = _alike(file, layout, element, name)
        if corners is not None:
            return fans(corners)
    collector = TriangleCollector()
    for lists in _rows(file, layout, element):
        collector.add(lists[name])
    return collector.triangles()


def _alike(file: IO[bytes], layout: PlyLayout, element: PlyElement, name: str) -> np.ndarray | None:
    """Return the lists of rows if all are as long as the first, and that is a polygon; or None."""
    start = file.tell()
    lengths = {one: len(items) for one, items in _row(file, layout, element).items()}
    file.seek(start)
    if lengths[name] < 3:
        return None
    row: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    for field, code in element.fields:
        if field in lengths:
            row.append((f"length of {field}", layout.order + element.lengths[field]))
            row.append((field, layout.order + code, (lengths[field],)))
        else:
            row.append((field, layout.order + code))
    kind = np.dtype(row)
    data = file.read(kind.itemsize * element.count)
    if len(data) == kind.itemsize * element.count:
        numbers = np.frombuffer(data, kind)
        if all((numbers[f"length of {one}"] == lengths[one]).all() for one in lengths):
            return np.asarray(numbers[name])
    file.seek(start)
    return None


def _rows(
    file: IO[bytes], layout: PlyLayout, element: PlyElement
) -> Iterator[Mapping[str, Sequence[int]]]:
    """Read rows one by one; yield the lists of each by their names."""
    if not layout.order:
        yield from (_lists(words, element) for words in _lines(file, element))
    elif not element.has_list:
        _plain(file, layout, element)
    else:
        for _ in range(element.count):
            yield _row(file, layout, element)


def _row(file: IO[bytes], layout: PlyLayout, element: PlyElement) -> Mapping[str, Sequence[int]]:
    lists = {}
    for field, code in element.fields:
        count = 1
        if field in element.lengths:
            (count,) = _numbers(file, layout, element.lengths[field], 1)
        numbers = _numbers(file, layout, code, count)
        if field in element.lengths:
            lists[field] = numbers
    return lists


def _numbers(file: IO[bytes], layout: PlyLayout, code: str, count: int) -> tuple[int, ...]:
    if count < 0:
        raise MeshDamageError(f"a list has the length {count}")
    size = count * int(code[1])
    data = file.read(size)
    if len(data) < size:
        raise MeshDamageError("it is cut short: rows are missing")
    return struct.unpack(f"{layout.order}{count}{_LETTERS[code]}", data)


def _plain(file: IO[bytes], layout: PlyLayout, element: PlyElement) -> np.ndarray:
    """Read rows without lists."""
    row = np.dtype([(name, layout.order + code) for name, code in element.fields])
    data = file.read(row.itemsize * element.count)
    if len(data) < row.itemsize * element.count:
        raise MeshDamageError(f"it is cut short: it promises {element.count} {element.name} rows")
    return np.frombuffer(data, row, element.count if row.itemsize else 0)


def _lines(file: IO[bytes], element: PlyElement) -> Iterator[list[bytes]]:
    """Yield the words of the rows of a text file."""
    for number in range(element.count):
        words = file.readline().split()
        if len(words) < len(element.fields):
            raise MeshDamageError(
                f"it promises {element.count} {element.name} rows, and row {number + 1} is "
                "missing or cut short"
            )
        yield words


def _lists(words: list[bytes], element: PlyElement) -> Mapping[str, Sequence[int]]:
    lists, at = {}, 0
    for field, code in element.fields:
        count = 1
        if field in element.lengths:
            count, at = int(words[at]), at + 1
            if not 0 <= count <= len(words) - at:
                raise MeshDamageError(f"a list has the length {count}")
            is_whole = not code.startswith("f")
            lists[field] = [int(word) for word in words[at : at + count]] if is_whole else []
        at += count
    return lists
