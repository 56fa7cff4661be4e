"""Triangle meshes from OBJ, PLY and STL files, read with limits of memory and time."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from executive.arrays import Float, Int
from executive.clouds.meshes.damage import MeshDamageError
from executive.clouds.meshes.obj import read_obj
from executive.clouds.meshes.ply_mesh import read_ply_mesh
from executive.clouds.meshes.stl import read_stl
from executive.clouds.meshes.triangle_collector import check_corners
from executive.confined.client import read_confined
from executive.errors import DataError

_READERS: dict[str, Callable[[Path], tuple[Float, Int]]] = {
    ".obj": read_obj,
    ".ply": read_ply_mesh,
    ".stl": read_stl,
}
SUFFIXES = tuple(_READERS)


def read_mesh(path: Path) -> tuple[Float, Int]:
    """Return the vertices and triangles of a mesh.

    Vertices at one place are one vertex, and triangles with fewer than three different corners are
    left out. Whether the mesh is closed is not checked.

    Args:
        path: A file that ends in one of `SUFFIXES`.

    Returns:
        Vertices in the unit of the file, shape (N, 3), and the indices of the corners of triangles,
        shape (M, 3).

    Raises:
        DataError: If it cannot be read as a mesh, has no triangle, or takes more memory or time
            than its size explains.
    """
    try:
        vertices, triangles = read_confined("executive.clouds.meshes.reader:mesh_of", path)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    return vertices, triangles


def mesh_of(path: Path) -> tuple[Float, Int]:
    """Read a mesh in this process; see `read_mesh`."""
    try:
        vertices, triangles = _READERS[path.suffix.lower()](path)
        check_corners(triangles, vertices)
    except (MeshDamageError, ValueError) as damage:
        raise _unreadable(path, f" ({damage})") from None
    vertices, triangles = _joined(path, vertices, triangles)
    corners = triangles.T
    a, b, c = corners
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    if not len(triangles) or not np.isfinite(vertices).all():
        raise _unreadable(path, "")
    return vertices, triangles


def _unreadable(path: Path, reason: str) -> DataError:
    return DataError(
        f"{path}: not a readable mesh{reason}; export it again as OBJ, PLY or STL, or remove it "
        "from the folder"
    )


def _joined(path: Path, vertices: Float, triangles: Int) -> tuple[Float, Int]:
    """Join vertices at one place.

    They come in the order of the file in PLY files, and in the order in which triangles name them
    in others.
    """
    if path.suffix.lower() != ".ply":
        vertices, triangles = vertices[triangles.ravel()], np.arange(triangles.size)
    _, first, inverse = np.unique(vertices + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return vertices[first[order]], rank[inverse.ravel()][triangles.reshape(-1, 3)]
