"""Triangles from Wavefront OBJ files."""

from array import array
from pathlib import Path

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.meshes.damage import MeshDamageError
from executive.clouds.meshes.triangle_collector import TriangleCollector


def read_obj(path: Path) -> tuple[Float, Int]:
    """Return vertices, shape (N, 3), and the indices of triangles' corners, shape (M, 3).

    Only `v` and `f` are read; all objects and groups make one mesh. Coordinates are rounded to
    single precision.

    Raises:
        MeshDamageError: If a line cannot be parsed; it names the line.
    """
    vertices, faces = array("f"), TriangleCollector()
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            words = line.partition(b"#")[0].split()
            try:
                if words[:1] == [b"v"]:
                    x, y, z = (float(word) for word in words[1:4])
                    vertices.extend((x, y, z))
                elif words[:1] == [b"f"]:
                    faces.add(_corners(words[1:], len(vertices) // 3))
            except (ValueError, OverflowError, MeshDamageError) as error:
                raise MeshDamageError(f"line {number}: {error}") from None
    return np.array(vertices, dtype=float).reshape(-1, 3), faces.triangles()


def _corners(words: list[bytes], vertices: int) -> list[int]:
    """Return indices from 0; in the file they count from 1, or backwards from -1."""
    written = [int(word.split(b"/", 1)[0]) for word in words]
    corners = [vertices + one if one < 0 else one - 1 for one in written]
    if any(one < 0 for one in corners):
        raise MeshDamageError(f"a face names a vertex before the first: {min(written)}")
    return corners
