"""What the reader of each format returns: shapes, order of corners, and where damage is."""

import struct
from pathlib import Path

import numpy as np
import pytest

from executive.clouds.meshes.damage import MeshDamageError
from executive.clouds.meshes.obj import read_obj
from executive.clouds.meshes.ply_mesh import read_ply_mesh
from executive.clouds.meshes.stl import read_stl
from executive.clouds.meshes.triangle_collector import TriangleCollector, check_corners, fans

PLACES = np.arange(36.0).reshape(12, 3)  # of four triangles: also divisible otherwise


def text_stl(places: np.ndarray) -> str:
    corners = "".join(f"  vertex {x} {y} {z}\n" for x, y, z in places)
    return f"solid made up\nfacet normal 0 0 1\n{corners}endfacet\nendsolid made up\n"


def binary_stl(places: np.ndarray) -> bytes:
    rows = [
        np.zeros(3, "<f4").tobytes() + three.astype("<f4").tobytes() + b"\0\0"
        for three in places.reshape(-1, 9)
    ]
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)


@pytest.mark.parametrize("content", [text_stl(PLACES).encode(), binary_stl(PLACES)])
def test_each_triangle_of_an_stl_file_has_three_vertices_of_its_own(
    tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "a.stl"
    path.write_bytes(content)
    vertices, triangles = read_stl(path)
    assert vertices.tolist() == PLACES.tolist()
    assert vertices.dtype == float
    assert triangles.tolist() == [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (text_stl(PLACES[:11]).encode(), "cut short: no whole triangle and 'endsolid'"),
        (text_stl(PLACES).replace("endsolid", "end").encode(), "cut short: no whole triangle"),
        (text_stl(PLACES).replace("vertex 9.0 10.0", "vertex 9.0 ten").encode(), "^line 6: could"),
        (binary_stl(PLACES) + b"\0", "^4 triangles would be 284 bytes; it has 285$"),
        (b"neither", "^0 triangles would be 84 bytes; it has 7$"),
    ],
)
def test_damage_of_an_stl_file_is_told(tmp_path: Path, content: bytes, told: str) -> None:
    path = tmp_path / "a.stl"
    path.write_bytes(content)
    with pytest.raises(MeshDamageError, match=told):
        read_stl(path)


def test_faces_of_an_obj_file_count_from_one_or_backwards(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(
        "# made up\no first\nv 0 0 0 1.0\nv 1.5 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 # a square\n"
        "g second\nv 0 0 -2\nf -1/7 -5//3 2/1/1\nf\t1 2 5\n"
    )
    vertices, triangles = read_obj(path)
    assert vertices.tolist() == [[0, 0, 0], [1.5, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, -2]]
    expected = [[0, 1, 2], [0, 2, 3], [4, 0, 1], [0, 1, 4]]
    assert triangles.tolist() == expected
    for line, told in [
        ("f 0 1 2", "line 12: a face names a vertex before the first: 0"),
        ("f 1 2", "line 12: a face has 2 corners, and 3 are the least"),
        ("v 1 2", "line 12: not enough values to unpack"),
        ("f 1 2 x", "line 12: invalid literal"),
        ("f 1 2 99999999999999999999", "line 12: a face has a corner 99999999999999999998"),
    ]:
        damaged = tmp_path / "damaged.obj"
        damaged.write_text(path.read_text() + line + "\n")
        with pytest.raises(MeshDamageError, match=told):
            read_obj(damaged)


HEAD = (
    "ply\nformat {form} 1.0\nelement vertex 4\nproperty double x\nproperty float quality\n"
    "property float y\nproperty float z\nelement edge 1\nproperty int a\nproperty int b\n"
    "element face {faces}\nproperty list uchar int vertex_index\nend_header\n"
)
ROWS = [(0, 9, 0, 0), (1, 9, 0, 0), (1, 9, 1, 0), (0, 9, 1, 0.5)]


def ply(form: str, faces: list[tuple[int, ...]]) -> bytes:
    head = HEAD.format(form=form, faces=len(faces)).encode()
    if form == "ascii":
        lines = [*ROWS, (0, 1), *[(len(one), *one) for one in faces]]
        return head + "\n".join(" ".join(map(str, one)) for one in lines).encode()
    order = "<" if "little" in form else ">"
    body = b"".join(struct.pack(f"{order}d3f", *one) for one in ROWS)
    body += struct.pack(f"{order}2i", 0, 1)
    return head + body + b"".join(struct.pack(f"{order}B{len(o)}i", len(o), *o) for o in faces)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize(
    ("faces", "expected"),
    [
        ([(0, 1, 2, 3), (3, 2, 1, 0)], [[0, 1, 2], [0, 2, 3], [3, 2, 1], [3, 1, 0]]),
        ([(0, 1, 2, 3), (1, 2, 3)], [[0, 1, 2], [0, 2, 3], [1, 2, 3]]),
        ([(2, 1, 0)], [[2, 1, 0]]),
        ([], []),
    ],
)
def test_triangles_of_a_ply_file(
    tmp_path: Path, form: str, faces: list[tuple[int, ...]], expected: list[list[int]]
) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(form, faces))
    vertices, triangles = read_ply_mesh(path)
    assert vertices.tolist() == [[x, y, z] for x, _, y, z in ROWS]
    assert triangles.tolist() == expected
    assert (triangles.dtype, triangles.shape[1]) == (np.int64, 3)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_a_face_with_two_corners_is_damage(tmp_path: Path, form: str) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(ply(form, [(0, 1), (1, 2)]))
    with pytest.raises(MeshDamageError, match="a face has 2 corners, and 3 are the least"):
        read_ply_mesh(path)


def test_polygons_are_split_into_fans_from_their_first_corner() -> None:
    collector = TriangleCollector()
    collector.add((4, 5, 6, 7, 8))
    expected = [[4, 5, 6], [4, 6, 7], [4, 7, 8]]
    assert collector.triangles().tolist() == expected
    assert fans(np.array([[4, 5, 6, 7, 8], [0, 1, 2, 3, 4]], dtype="u1")).tolist() == [
        *expected,
        *[[0, 1, 2], [0, 2, 3], [0, 3, 4]],
    ]
    assert TriangleCollector().triangles().shape == (0, 3)


def test_each_corner_names_a_vertex() -> None:
    vertices = np.zeros((3, 3))
    check_corners(np.empty((0, 3), np.int64), vertices)
    check_corners(np.array([[0, 1, 2]]), vertices)
    for wrong in (3, -1):
        with pytest.raises(MeshDamageError, match=f"has the corner {wrong} of 3 vertices"):
            check_corners(np.array([[0, 1, wrong]]), vertices)
