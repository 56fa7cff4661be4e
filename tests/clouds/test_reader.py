"""Files that are whole are read; files that are not are refused by name, with a cure."""

from pathlib import Path

import numpy as np
import open3d as o3d
import pytest

from executive.clouds.reader import read_points
from executive.errors import DataError

POINTS = np.random.default_rng(0).uniform(-5, 5, (400, 3)).astype(np.float32).astype(float)


def write(path: Path, points: np.ndarray = POINTS, **options: bool) -> Path:
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    assert o3d.io.write_point_cloud(path, cloud, **options)
    return path


@pytest.mark.parametrize("suffix", ["ply", "pcd", "xyz"])
@pytest.mark.parametrize("write_ascii", [True, False])
@pytest.mark.parametrize("compressed", [True, False])
def test_reads_what_was_written(
    tmp_path: Path, suffix: str, write_ascii: bool, compressed: bool
) -> None:
    path = write(tmp_path / f"site.{suffix}", write_ascii=write_ascii, compressed=compressed)
    # 1e-6 m: text files carry ten decimals at most.
    assert np.allclose(read_points(path), POINTS, atol=1e-6)


@pytest.mark.parametrize("suffix", ["ply", "pcd"])
@pytest.mark.parametrize("write_ascii", [True, False])
@pytest.mark.parametrize("compressed", [True, False])
@pytest.mark.parametrize("share", [0.3, 0.95])
def test_refuses_a_file_cut_short(
    tmp_path: Path, suffix: str, write_ascii: bool, compressed: bool, share: float
) -> None:
    path = write(tmp_path / f"site.{suffix}", write_ascii=write_ascii, compressed=compressed)
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * share)])
    with pytest.raises(DataError, match=rf"site\.{suffix}: .*(cut short|header).*again"):
        read_points(path)


def test_names_the_line_of_a_broken_xyz(tmp_path: Path) -> None:
    path = tmp_path / "site.xyz"
    path.write_text("# survey\n1 2 3\n\n4 five 6\n")
    with pytest.raises(DataError, match=r"site\.xyz:4: expected x y z, got '4 five 6'"):
        read_points(path)


def test_reads_an_xyz_with_commas_comments_and_colours(tmp_path: Path) -> None:
    path = tmp_path / "site.xyz"
    path.write_text("1,2,3 # corner\n4 5 6 255 0 0\n")
    assert read_points(path).tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize("suffix", ["ply", "pcd", "xyz"])
def test_leaves_out_points_that_are_not_finite_and_says_how_many(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, suffix: str
) -> None:
    points = POINTS.copy()
    points[7, 1], points[8, 2] = np.nan, np.inf
    read = read_points(write(tmp_path / f"site.{suffix}", points))
    assert np.allclose(read, np.delete(POINTS, [7, 8], axis=0), atol=1e-6)
    assert f"site.{suffix}: 2 of 400 points are not finite and are left out" in caplog.text


def test_refuses_a_cloud_of_which_nothing_is_finite(tmp_path: Path) -> None:
    path = write(tmp_path / "site.pcd", np.full((9, 3), np.nan))
    with pytest.raises(DataError, match="none of its 9 points is finite"):
        read_points(path)


def test_keeps_each_point_once_in_its_order(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    twice = np.vstack([POINTS, POINTS[::-1], POINTS[:7]])
    assert np.array_equal(read_points(write(tmp_path / "site.ply", twice)), POINTS)
    assert "407 of 807 points repeat others" in caplog.text


def test_refuses_coordinates_beyond_any_grid(tmp_path: Path) -> None:
    path = write(tmp_path / "site.ply", POINTS * 1e8)
    with pytest.raises(
        DataError, match=r"site\.ply: a coordinate of .* is beyond .* scale or shift"
    ):
        read_points(path)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.ply", b"", "lacks a header from 'ply' to 'end_header'"),
        ("noise.ply", bytes(range(256)) * 9, "lacks a header"),
        ("long.ply", b"ply\n" + b"comment a\n" * 7000 + b"end_header\n", "not end within 65,536"),
        ("faces.ply", b"ply\nformat ascii 1.0\nelement face "
b"0\nend_header\n", "no vertices with x, y and z"),
        ("odd.ply", b"ply\nformat ascii 1.0\nelement vertex "
b"many\nend_header\n", "cannot be parsed"),
        ("none.ply", b"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float "
b"y\n"
         b"property float z\nend_header\n", "holds no points"),
        ("empty.pcd", b"", "lacks a header with FIELDS"),
        ("flat.pcd", b"FIELDS x y\nSIZE 4 4\nPOINTS 1\nDATA ascii\n1 2\n", "no fields x, y and z"),
        ("odd.pcd", b"FIELDS x y z\nSIZE 4 4 4\nPOINTS 1\nDATA morse\n1 2 "
b"3\n", "cannot be parsed"),
        ("empty.xyz", b"", "holds no points"),
        ("site.e57", b"ASTM-E57", "it has no E57 header"),
        ("site.rcp", b"AUTODESK", "not a supported cloud format; convert it to .ply, .pcd, "
".las, "
".laz, "
".e57, "
".xyz"),
        ("site.ply.gz", b"\x1f\x8b\x08", "compressed by gzip; unpack it"),
    ],
)  # fmt: skip
def test_refuses_what_is_no_cloud(tmp_path: Path, name: str, content: bytes, words: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(DataError, match=words) as refusal:
        read_points(path)
    assert str(path) in str(refusal.value)


def test_refuses_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"nowhere\.ply: no such file; give the path"):
        read_points(tmp_path / "nowhere.ply")
