"""Triangles from STL files, binary or text."""

import struct
from array import array
from pathlib import Path

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.meshes.damage import MeshDamageError

_HEADER = 84  # bytes: a comment of 80, and the number of triangles
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path) -> tuple[Float, Int]:
    """Return vertices, shape (N, 3), and the indices of triangles' corners, shape (M, 3).

    Each triangle has three vertices of its own, because the format has no indices.

    Raises:
        MeshDamageError: If its size is not that of its triangles, or a line cannot be parsed.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        header = file.read(_HEADER)
    count = struct.unpack_from("<I", header, 80)[0] if len(header) == _HEADER else 0
    wanted = _HEADER + count * _TRIANGLE.itemsize
    if size == wanted:
        rows = np.fromfile(path, _TRIANGLE, count, offset=_HEADER)
        vertices = rows["corners"].reshape(-1, 3).astype(float)
    elif header.lstrip().startswith(b"solid"):
        vertices = _text(path)
    else:
        raise MeshDamageError(f"{count} triangles would be {wanted} bytes; it has {size}")
    return vertices, np.arange(len(vertices), dtype=np.int64).reshape(-1, 3)


def _text(path: Path) -> Float:
    vertices, last = array("f"), b""
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            words = line.split()
            last = words[0] if words else last
            if words[:1] != [b"vertex"]:
                continue
            try:
                x, y, z = (float(word) for word in words[1:4])
                vertices.extend((x, y, z))
            except (ValueError, OverflowError) as error:
                raise MeshDamageError(f"line {number}: {error}") from None
    if last != b"endsolid" or len(vertices) % 9:
        raise MeshDamageError("cut short: no whole triangle and 'endsolid' at its end")
    return np.array(vertices, dtype=float).reshape(-1, 3)
