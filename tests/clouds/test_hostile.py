"""Files that lie, break off, or say one thing and hold another: refused with a cure, or read right;
never wrong.
"""

import os
import struct
from pathlib import Path

import numpy as np
import open3d as o3d
import pytest

from executive.clouds.reader import read_points
from executive.errors import DataError

POINTS = np.random.default_rng(0).uniform(-5, 5, (400, 3)).astype(np.float32)
XYZ = b"".join(b"property float %c\n" % axis for axis in b"xyz")


def ply(
    path: Path, count: int, body: bytes, form: str = "binary_little_endian", properties: bytes = XYZ
) -> Path:
    head = (
        f"ply\nformat {form} 1.0\nelement vertex {count}\n".encode() + properties + b"end_header\n"
    )
    path.write_bytes(head + body)
    return path


def pcd(path: Path, count: int, body: bytes, form: str = "binary", size: int = 4) -> Path:
    sizes = " ".join([str(size)] * 3)
    head = (
        f"FIELDS x y z\nSIZE {sizes}\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT "
        f"1\nPOINTS {count}\nDATA {form}\n"
    )
    path.write_bytes(head.encode() + body)
    return path


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_a_ply_that_claims_billions_of_points_is_refused(tmp_path: Path, form: str) -> None:
    path = ply(tmp_path / "claim.ply", 4_000_000_000, b"1 2 3\n" * 100, form)
    with pytest.raises(DataError, match="cut short: the header promises 4000000000 points"):
        read_points(path)


@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_a_pcd_that_claims_billions_of_points_is_refused(tmp_path: Path, form: str) -> None:
    with pytest.raises(DataError, match="cut short: the header promises 4000000000 points"):
        read_points(pcd(tmp_path / "claim.pcd", 4_000_000_000, b"1 2 3\n" * 100, form))


@pytest.mark.parametrize(
    ("width", "height", "is_right"), [(20, 20, True), (400, 1, True), (800, 2, False)]
)
def test_a_pcd_has_as_many_points_as_columns_times_rows(
    tmp_path: Path, width: int, height: int, is_right: bool
) -> None:
    path = pcd(tmp_path / "site.pcd", 400, POINTS.tobytes())
    head = path.read_bytes().replace(
        b"WIDTH 400\nHEIGHT 1\n", b"WIDTH %d\nHEIGHT %d\n" % (width, height)
    )
    path.write_bytes(head)
    if is_right:
        assert len(read_points(path)) == 400
        return
    with pytest.raises(DataError, match="WIDTH times HEIGHT is not 400"):
        read_points(path)


def test_a_compressed_pcd_that_claims_more_than_can_be_packed_is_refused(tmp_path: Path) -> None:
    body = struct.pack("<II", 100, 0xFFFFFFFF) + bytes(100)
    with pytest.raises(DataError, match="300000000 points cannot be in 100 packed bytes"):
        read_points(pcd(tmp_path / "claim.pcd", 300_000_000, body, "binary_compressed"))


def test_a_file_of_holes_that_claims_a_billion_points_is_refused(tmp_path: Path) -> None:
    """The size fits the claim: a sparse file costs its maker nothing."""
    count = 1_000_000_000
    path = ply(tmp_path / "holes.ply", count, b"")
    os.truncate(path, path.stat().st_size + 12 * count)
    with pytest.raises(
        DataError, match="1000000000 points are more than 5e\\+08; thin or crop the cloud"
    ):
        read_points(path)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("suffix", ["ply", "pcd"])
@pytest.mark.parametrize("write_ascii", [True, False])
def test_a_damaged_header_or_body_is_an_error_or_is_read(
    tmp_path: Path, suffix: str, write_ascii: bool, seed: int
) -> None:
    """No crash and no other error, whatever bytes are changed."""
    path = tmp_path / f"site.{suffix}"
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(POINTS.astype(float)))
    assert o3d.io.write_point_cloud(path, cloud, write_ascii=write_ascii, compressed=bool(seed % 2))
    content, rng = bytearray(path.read_bytes()), np.random.default_rng(seed)
    for place in rng.integers(0, 300 if seed % 3 else len(content), 3):
        content[place] = rng.integers(0, 256)
    path.write_bytes(content)
    try:
        assert np.isfinite(read_points(path)).all()
    except DataError as refusal:
        assert path.name in str(refusal)  # noqa: PT017 - either way is right


def test_both_byte_orders_are_read(tmp_path: Path) -> None:
    little = ply(tmp_path / "little.ply", 400, POINTS.astype("<f4").tobytes())
    big = ply(tmp_path / "big.ply", 400, POINTS.astype(">f4").tobytes(), "binary_big_endian")
    assert np.array_equal(read_points(little), POINTS)
    assert np.array_equal(read_points(big), POINTS)


def test_the_wrong_byte_order_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"a coordinate of .* is beyond .* if they are nonsense"):
        read_points(ply(tmp_path / "swapped.ply", 400, POINTS.astype(">f4").tobytes()))


def test_binary_that_is_called_text_is_refused(tmp_path: Path) -> None:
    path = ply(tmp_path / "site.ply", 400, POINTS.tobytes(), "ascii")
    with pytest.raises(DataError, match=r"site\.ply: .*export it again"):
        read_points(path)


def test_colours_normals_and_faces_are_passed_over(tmp_path: Path) -> None:
    properties = (
        XYZ + b"property uchar red\nproperty double nx\nelement face 1\nproperty list uchar "
        b"int vertex_indices\n"
    )
    rows = np.zeros(400, dtype=[("xyz", "<f4", 3), ("red", "u1"), ("nx", "<f8")])
    rows["xyz"] = POINTS
    faces = struct.pack("<Biii", 3, 0, 1, 2)
    assert np.array_equal(
        read_points(ply(tmp_path / "mesh.ply", 400, rows.tobytes() + faces, properties=properties)),
        POINTS,
    )


def test_a_text_ply_with_another_element_before_its_points_is_read(tmp_path: Path) -> None:
    head = (
        b"ply\nformat ascii 1.0\nelement camera 2\nproperty float fx\nelement vertex 2\n"
        + XYZ
        + b"end_header\n"
    )
    (tmp_path / "site.ply").write_bytes(head + b"1\n2\n1 2 3\n4 5 6\n")
    assert read_points(tmp_path / "site.ply").tolist() == [[1, 2, 3], [4, 5, 6]]


def test_lists_before_the_points_of_a_binary_ply_are_refused(tmp_path: Path) -> None:
    head = (
        b"ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar int "
        b"vertex_indices\n"
    )
    (tmp_path / "site.ply").write_bytes(
        head + b"element vertex 1\n" + XYZ + b"end_header\n" + bytes(99)
    )
    with pytest.raises(DataError, match="has lists in its vertices or before them"):
        read_points(tmp_path / "site.ply")


def test_a_pcd_with_padding_and_arrays_is_read(tmp_path: Path) -> None:
    head = (
        b"FIELDS x _ y histogram z\nSIZE 4 1 4 4 8\nTYPE F U F F F\nCOUNT 1 4 1 3 1\nPOINTS "
        b"2\nDATA ascii\n"
    )
    (tmp_path / "site.pcd").write_bytes(head + b"1 0 0 0 0 2 7 7 7 3\n4 0 0 0 0 5 7 7 7 6\n")
    assert read_points(tmp_path / "site.pcd").tolist() == [[1, 2, 3], [4, 5, 6]]


def test_what_a_cloud_is_counts_more_than_its_name(tmp_path: Path) -> None:
    path = ply(tmp_path / "site.xyz", 400, POINTS.tobytes())
    assert np.array_equal(read_points(path), POINTS)


@pytest.mark.parametrize(
    "text",
    [
        "x y z\n1 2 3\n4 5 6\n",
        "//X Y Z R\n1 2 3 9\n4 5 6 9\n",
        "\ufeff1;2;3\r\n4;5;6\r\n",
        '"X","Y","Z"\n1,2,3\n4,5,6',
        "1\t2\t3\n4 5\t6",
    ],
)
def test_tables_as_programs_write_them_are_read(tmp_path: Path, text: str) -> None:
    path = tmp_path / "site.txt"
    path.write_bytes(text.encode("utf-8"))
    assert read_points(path).tolist() == [[1, 2, 3], [4, 5, 6]]


def test_the_count_at_the_head_of_a_pts_file_is_no_point(tmp_path: Path) -> None:
    (tmp_path / "site.pts").write_text("2\n1 2 3 -5 9 9 9\n4 5 6 -5 9 9 9\n")
    assert read_points(tmp_path / "site.pts").tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("1 2 3\n".encode("utf-16"), "text in UTF-16; save it as UTF-8"),
        ("1 2 3\n".encode("utf-16-le"), "not lines of numbers"),
        (b"1,5;2,5;3,5\n", r"site\.xyz:1: .* has decimal commas; export it with decimal points"),
        (b"1,5 2,5 3,5\n", "decimal commas"),
        (b"1 2 3\n1 2 3e\n4 5 6\n", r"site\.xyz:2: expected x y z, got '1 2 3e'"),
        (b"1 2 3\n4 5", "cut short: ends in line 2"),
        (bytes(range(256)) * 999, "not lines of numbers"),
        (b"1 " * 99_999, "not lines of numbers"),
    ],
)
def test_text_that_is_no_table_of_points_is_refused(
    tmp_path: Path, content: bytes, words: str
) -> None:
    path = tmp_path / "site.xyz"
    path.write_bytes(content)
    with pytest.raises(DataError, match=words):
        read_points(path)
