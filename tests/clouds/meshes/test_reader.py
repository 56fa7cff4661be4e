"""Meshes are read as Open3D reads them, and damage is refused with its place."""

import struct
from pathlib import Path

import numpy as np
import open3d as o3d
import pytest

from executive.clouds.meshes.reader import mesh_of, read_mesh
from executive.errors import DataError

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
PLY_HEAD = (
    "ply\nformat {form} 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty uchar red\n"
    "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
)
FLOAT_CORNERS = (
    PLY_HEAD.replace("int vertex", "float vertex").format(form="ascii")
    + "0 0 0\n" * 5
    + "9 3 0 1 2 0\n" * 2
)
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)]


def written(tmp_path: Path, name: str, content: bytes | str) -> Path:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize("name", ["a.obj", "a.stl", "a.ply", "text.ply"])
def test_a_mesh_is_what_open3d_reads(tmp_path: Path, name: str) -> None:
    mesh = o3d.geometry.TriangleMesh.create_sphere(0.7, resolution=8)
    mesh.compute_triangle_normals()
    path = tmp_path / name
    with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
        assert o3d.io.write_triangle_mesh(path, mesh, write_ascii=name.startswith("text"))
        theirs = o3d.io.read_triangle_mesh(path)
    theirs.remove_duplicated_vertices()
    theirs.remove_degenerate_triangles()
    vertices, triangles = read_mesh(path)
    # Open3D's reader of OBJ rounds some decimals to the next but one number of single precision.
    assert np.allclose(vertices, np.asarray(theirs.vertices), rtol=0, atol=2e-7)
    assert np.array_equal(triangles, np.asarray(theirs.triangles))


def test_faces_of_any_length_become_triangles(tmp_path: Path) -> None:
    quads = (
        "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "f 1//1 2//1 3//1 4//1\nf -5 -4 -1\n"
    )
    _, triangles = mesh_of(written(tmp_path, "a.obj", quads))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4]]


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_faces_with_lists_of_different_lengths_are_read(tmp_path: Path, form: str) -> None:
    faces = [(9, (0, 1, 2, 3), (0.5,)), (8, (0, 1, 4), ())]
    if form == "ascii":
        rows = [" ".join(map(str, corner)) for corner in CORNERS]
        rows += [
            " ".join(map(str, (red, len(corners), *corners, len(extra), *extra)))
            for red, corners, extra in faces
        ]
        body = "\n".join(rows).encode()
    else:
        order = "<" if form == "binary_little_endian" else ">"
        body = b"".join(struct.pack(f"{order}3f", *corner) for corner in CORNERS)
        for red, corners, extra in faces:
            body += struct.pack(f"{order}BB{len(corners)}i", red, len(corners), *corners)
            body += struct.pack(f"{order}B{len(extra)}f", len(extra), *extra)
    path = written(tmp_path, "a.ply", PLY_HEAD.format(form=form).encode() + body)
    vertices, triangles = mesh_of(path)
    assert vertices.tolist() == [list(map(float, corner)) for corner in CORNERS]
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4]]


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", TETRAHEDRON.replace("f 2 3 4", "f 2 3 9"), "the corner 8 of 4 vertices"),
        ("a.obj", TETRAHEDRON.replace("f 2 3 4", "f -9 3 4"), "line 7: .*before the first: -9"),
        ("a.obj", TETRAHEDRON.replace("v 0 1 0", "v 0 1"), "line 3: not enough values"),
        ("a.obj", TETRAHEDRON.replace("f 2 3 4", "f 2 3"), "line 7: a face has 2 corners"),
        ("a.obj", TETRAHEDRON.replace("f 2 3 4", "f 2 3 " + "9" * 30), "7: a face has a corner"),
        ("a.obj", TETRAHEDRON.replace("v 0 1 0", "v 0 nan 0"), "not a readable mesh; export"),
        ("a.obj", "v 0 0 0\n", "not a readable mesh; export"),
        ("a.stl", bytes(80) + struct.pack("<I", 4_000_000_000), "would be 200000000084 bytes"),
        ("a.stl", b"solid x\nfacet\nvertex 0 0 0\nvertex 0 0 1\n", "cut short"),
        ("a.stl", b"solid x\nvertex 0 0 zero\nendsolid", "line 2: could not convert"),
        ("a.ply", PLY_HEAD.format(form="ascii").replace("face 2", "face 3000000000"), "in 0 bytes"),
        ("a.ply", PLY_HEAD.format(form="ascii") + "0 0 0\n" * 2 + "00", "5 vertex .* in 14 b"),
        ("a.ply", FLOAT_CORNERS, "no list 'vertex_indices' of whole numbers"),
        ("a.ply", PLY_HEAD.format(form="ascii") + "0 0 0\n" * 3 + "0 0\n" * 9, "row 4 is missing"),
        (
            "a.ply",
            PLY_HEAD.format(form="binary_little_endian").encode() + bytes(60) + b"\x09\xff" * 9,
            "cut short: rows are missing",
        ),
    ],
)  # fmt: skip
def test_damage_is_refused_with_its_place(
    tmp_path: Path, name: str, content: bytes | str, words: str
) -> None:
    with pytest.raises(DataError, match=rf"{name}: not a readable mesh.*{words}|{words}"):
        mesh_of(written(tmp_path, name, content))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"none\.obj: cannot be read: No such file"):
        read_mesh(tmp_path / "none.obj")
