"""A survey from a file: merged, centred, and refused when it is no site."""

from pathlib import Path

import laspy
import numpy as np
import open3d as o3d
import pytest
from executive_plugins.surveying.point_cloud_file import PointCloudFile
from executive_plugins.surveying.settings import PointCloudFileSettings

from executive.errors import DataError

SITE = np.random.default_rng(1).uniform(0, 8, (2000, 3))


def survey(path: Path, points: np.ndarray) -> np.ndarray:
    assert o3d.io.write_point_cloud(
        path, o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    )
    return PointCloudFile(PointCloudFileSettings(path=path)).survey(np.random.default_rng(0)).points


def test_keeps_the_shape_of_a_cloud_in_national_coordinates(tmp_path: Path) -> None:
    points = survey(tmp_path / "site.ply", SITE + np.array([2_683_000.0, 1_247_000.0, 440.0]))
    assert np.abs(points).max() < 5
    # 1 mm: sparse points are alone in their cells, and double precision has micrometres left at
    # 2,683 km.
    assert np.allclose(np.ptp(points, axis=0), np.ptp(SITE, axis=0), atol=1e-3)


def test_merges_points_of_one_cell(tmp_path: Path) -> None:
    twice = np.vstack([SITE, SITE + 1e-4])
    assert len(survey(tmp_path / "site.ply", twice)) < 1.1 * len(SITE)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (SITE[:20], "20 points, at least 100 are a survey"),
        (SITE * 1000, "in millimetres it would be 8 m: scale it by 0.001"),
        (SITE / 1000, "0.008 m across is too small for a site"),
    ],
)
def test_refuses_what_is_no_site(tmp_path: Path, points: np.ndarray, words: str) -> None:
    with pytest.raises(DataError, match=words):
        survey(tmp_path / "site.ply", points)


def test_a_wide_site_is_allowed_by_a_setting(tmp_path: Path) -> None:
    path = tmp_path / "quarry.ply"
    assert o3d.io.write_point_cloud(
        path, o3d.geometry.PointCloud(o3d.utility.Vector3dVector(SITE * 100))
    )
    with pytest.raises(DataError, match=r"[78]\d\d.* across is too wide for a site"):
        PointCloudFile(PointCloudFileSettings(path=path)).survey(np.random.default_rng(0))
    wide = PointCloudFile(PointCloudFileSettings(path=path, max_extent_m=1000)).survey(
        np.random.default_rng(0)
    )
    assert len(wide) == len(SITE)


def test_reads_a_laz_in_national_coordinates(tmp_path: Path) -> None:
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.scales, header.offsets = np.full(3, 0.001), np.array([2_683_000.0, 1_247_000.0, 440.0])
    data = laspy.LasData(header)
    data.xyz = SITE + header.offsets
    data.write(tmp_path / "site.laz")
    points = (
        PointCloudFile(PointCloudFileSettings(path=tmp_path / "site.laz"))
        .survey(np.random.default_rng(0))
        .points
    )
    assert np.abs(points).max() < 5
    assert np.allclose(
        np.ptp(points, axis=0), np.ptp(SITE, axis=0), atol=2e-3
    )  # the file's own millimetre


def test_single_precision_in_national_coordinates_is_refused(tmp_path: Path) -> None:
    rounded = (SITE + np.array([2_683_000.0, 1_247_000.0, 440.0])).astype(np.float32)
    with pytest.raises(DataError, match=r"in steps of 0\.25 m"):
        survey(tmp_path / "site.ply", rounded.astype(float))
