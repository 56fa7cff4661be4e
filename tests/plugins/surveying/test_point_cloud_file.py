"""A survey from a file: merged, centred, and refused when it is no site."""

from pathlib import Path

import numpy as np
import open3d as o3d
import pytest

from executive.errors import DataError
from plugins.surveying.point_cloud_file import PointCloudFile, PointCloudFileSettings

SITE = np.random.default_rng(1).uniform(0, 8, (2000, 3))


def survey(path: Path, points: np.ndarray) -> np.ndarray:
    assert o3d.io.write_point_cloud(path, o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points)))
    return PointCloudFile(PointCloudFileSettings(path=path)).survey(np.random.default_rng(0)).points


def test_keeps_the_shape_of_a_cloud_in_national_coordinates(tmp_path: Path) -> None:
    points = survey(tmp_path / "site.ply", SITE + np.array([2_683_000.0, 1_247_000.0, 440.0]))
    assert np.abs(points).max() < 5
    # 1 mm: sparse points are alone in their cells, and double precision has micrometres left at 2,683 km.
    assert np.allclose(np.ptp(points, axis=0), np.ptp(SITE, axis=0), atol=1e-3)


def test_merges_points_of_one_cell(tmp_path: Path) -> None:
    twice = np.vstack([SITE, SITE + 1e-4])
    assert len(survey(tmp_path / "site.ply", twice)) < 1.1 * len(SITE)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (SITE[:20], "20 points, at least 100 are a survey"),
        (SITE * 1000, "across, allowed is 0.5 to 500 m; coordinates are in metres"),
        (SITE / 1000, "across, allowed is 0.5 to 500 m"),
    ],
)
def test_refuses_what_is_no_site(tmp_path: Path, points: np.ndarray, words: str) -> None:
    with pytest.raises(DataError, match=words):
        survey(tmp_path / "site.ply", points)
