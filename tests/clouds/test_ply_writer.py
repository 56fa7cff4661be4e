"""PLY files that were written are read back as the same points."""

from pathlib import Path

import numpy as np
import open3d as o3d

from executive.clouds.ply_writer import write_parts, write_ply
from executive.clouds.reader import read_points

POINTS = np.random.default_rng(0).uniform(-1e6, 1e6, (1000, 3))


def test_points_survive_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "cloud.ply"
    write_ply(path, POINTS, "map")
    np.testing.assert_array_equal(read_points(path), POINTS)
    assert b"\ncomment frame map\n" in path.read_bytes()


def test_parts_have_colours_of_their_own_that_other_tools_read(tmp_path: Path) -> None:
    path = tmp_path / "parts.ply"
    parts = [POINTS[:300], np.empty((0, 3)), POINTS[300:700], POINTS[700:]]
    write_parts(path, parts)
    np.testing.assert_array_equal(read_points(path), POINTS)
    colours = np.asarray(o3d.io.read_point_cloud(str(path)).colors)
    by_part = [
        np.unique(colours[rows], axis=0) for rows in (range(300), range(300, 700), range(700, 1000))
    ]
    assert [len(part) for part in by_part] == [1, 1, 1]
    assert len(np.unique(np.vstack(by_part), axis=0)) == 3


def test_no_points_make_a_valid_file(tmp_path: Path) -> None:
    path = tmp_path / "empty.ply"
    write_parts(path, [])
    assert b"\nelement vertex 0\n" in path.read_bytes()
    assert path.read_bytes().endswith(b"end_header\n")
