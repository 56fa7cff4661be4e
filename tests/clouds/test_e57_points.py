"""E57 files read in this process: poses, kinds of coordinates, what is carried, and damage."""

from pathlib import Path

import numpy as np
import pytest

from executive.clouds.e57_points import e57_cloud, e57_crs, e57_points
from executive.errors import DataError
from executive.geometry.rotation import from_rpy
from tests.clouds.e57_files import COLOURS, Scan, write_e57

LOCAL = np.round(np.random.default_rng(5).uniform(-4, 4, (50, 3)), 4)
TILTED = (0.8, -0.36, 0.48, 0.0)
YAWED = (np.cos(0.35), 0.0, 0.0, np.sin(0.35))
ANY = tuple(np.array([0.3, -0.5, 0.7, 0.2]) / np.linalg.norm([0.3, -0.5, 0.7, 0.2]))


def cartesian(points: np.ndarray) -> dict[str, np.ndarray]:
    return dict(zip(("cartesianX", "cartesianY", "cartesianZ"), points.T, strict=True))


def turned_by(q_wxyz: tuple[float, ...], points: np.ndarray) -> np.ndarray:
    """Rotate by the sandwich product of quaternions, with no matrix."""
    w, v = q_wxyz[0], np.array(q_wxyz[1:])
    across = 2.0 * np.cross(v, points)
    return np.asarray(points + w * across + np.cross(v, across))


@pytest.mark.parametrize("q_wxyz", [(1.0, 0.0, 0.0, 0.0), YAWED, TILTED, ANY])
def test_a_scan_is_moved_by_its_pose_whatever_its_rotation(
    tmp_path: Path, q_wxyz: tuple[float, ...]
) -> None:
    t = (10.0, -20.0, 3.0)
    path = write_e57(tmp_path / "scan.e57", [Scan(cartesian(LOCAL), q_wxyz, t)])
    (points,) = e57_points(path)
    np.testing.assert_allclose(points, turned_by(q_wxyz, LOCAL) + t, rtol=0, atol=1e-9)


def test_a_yaw_turns_as_the_rotation_of_that_yaw(tmp_path: Path) -> None:
    path = write_e57(tmp_path / "scan.e57", [Scan(cartesian(LOCAL), YAWED)])
    (points,) = e57_points(path)
    np.testing.assert_allclose(points, LOCAL @ from_rpy(0, 0, 0.7).T, rtol=0, atol=1e-9)


def test_scans_follow_each_other_and_one_without_a_pose_stays_where_it_is(tmp_path: Path) -> None:
    scans = [Scan(cartesian(LOCAL[:20])), Scan(cartesian(LOCAL[20:]), t=(0.0, 0.0, 0.0))]
    (points,) = e57_points(write_e57(tmp_path / "two.e57", scans))
    np.testing.assert_allclose(points, LOCAL, rtol=0, atol=1e-12)


def test_whole_steps_are_scaled_to_metres(tmp_path: Path) -> None:
    path = write_e57(tmp_path / "steps.e57", [Scan(cartesian(LOCAL))], in_steps=True)
    np.testing.assert_allclose(e57_points(path)[0], LOCAL, rtol=0, atol=1e-9)


def test_range_azimuth_and_elevation_are_points(tmp_path: Path) -> None:
    distance = np.linalg.norm(LOCAL, axis=1)
    fields = {
        "sphericalRange": distance,
        "sphericalAzimuth": np.arctan2(LOCAL[:, 1], LOCAL[:, 0]),
        "sphericalElevation": np.arcsin(LOCAL[:, 2] / distance),
    }
    (points,) = e57_points(write_e57(tmp_path / "angles.e57", [Scan(fields)]))
    np.testing.assert_allclose(points, LOCAL, rtol=0, atol=1e-9)


@pytest.mark.parametrize("most", [255, 65535])
def test_colour_and_intensity_are_carried_and_the_rest_is_named(tmp_path: Path, most: int) -> None:
    colour = np.arange(150).reshape(50, 3) % 256
    scale = most // 255
    fields = cartesian(LOCAL) | dict(zip(COLOURS, scale * colour.T, strict=True))
    fields |= {"intensity": np.linspace(0, 1, 50), "timeStamp": np.arange(50.0)}
    points, found, intensity, left_out = e57_cloud(
        write_e57(tmp_path / "full.e57", [Scan(fields, most=most)])
    )
    np.testing.assert_allclose(points, LOCAL, rtol=0, atol=1e-12)
    assert found.shape == (50, 3)
    assert np.array_equal(found * (255 / found.max()) > 127, colour * (255 / colour.max()) > 127)
    np.testing.assert_allclose(intensity, np.linspace(0, 1, 50), rtol=1e-6)
    assert left_out.tobytes().decode() == "timeStamp"


def test_a_cloud_without_colour_has_none(tmp_path: Path) -> None:
    path = write_e57(tmp_path / "bare.e57", [Scan(cartesian(LOCAL))])
    _, colour, intensity, left_out = e57_cloud(path)
    assert (colour.shape, intensity.shape, left_out.size) == ((0, 3), (0,), 0)


def test_points_without_a_return_are_not_read_as_points(tmp_path: Path) -> None:
    lost = np.arange(50) % 5 == 0
    fields = cartesian(LOCAL) | {"cartesianInvalidState": 2.0 * lost}
    (points,) = e57_points(write_e57(tmp_path / "lost.e57", [Scan(fields)]))
    np.testing.assert_allclose(points[np.isfinite(points).all(1)], LOCAL[~lost], atol=1e-12)


@pytest.mark.parametrize("name", ["", "EPSG:2056"])
def test_the_coordinate_system_is_told_as_it_stands(tmp_path: Path, name: str) -> None:
    path = write_e57(tmp_path / "crs.e57", [Scan(cartesian(LOCAL))], name)
    assert e57_crs(path)[0].tobytes().decode() == name


def test_a_scan_without_coordinates_is_refused_with_what_it_has(tmp_path: Path) -> None:
    path = write_e57(tmp_path / "none.e57", [Scan({"intensity": np.ones(3)})])
    with pytest.raises(DataError, match=r"scan 0 has no coordinates, but intensity; export it"):
        e57_points(path)


@pytest.mark.parametrize("scale", [0.0, 0.5, 0.998, 1.002, 2.0])
def test_a_rotation_of_another_length_than_one_is_refused(tmp_path: Path, scale: float) -> None:
    q_wxyz = tuple(scale * np.array(TILTED))
    path = write_e57(tmp_path / "pose.e57", [Scan(cartesian(LOCAL), q_wxyz)])
    with pytest.raises(DataError, match="the pose of scan 0 is none"):
        e57_points(path)


@pytest.mark.parametrize("scale", [0.9992, 1.0008])
def test_a_rotation_of_printed_digits_is_made_one(tmp_path: Path, scale: float) -> None:
    q_wxyz = tuple(scale * np.array(TILTED))
    (points,) = e57_points(write_e57(tmp_path / "s.e57", [Scan(cartesian(LOCAL), q_wxyz)]))
    np.testing.assert_allclose(points, turned_by(TILTED, LOCAL), rtol=0, atol=1e-9)


@pytest.mark.parametrize("read", [e57_points, e57_cloud, e57_crs])
def test_a_file_that_is_cut_short_or_damaged_is_refused(tmp_path: Path, read) -> None:
    path = write_e57(tmp_path / "cut.e57", [Scan(cartesian(LOCAL))])
    whole = path.read_bytes()
    for content in (b"", whole[:40], whole[: len(whole) // 2], b"x" + whole[1:]):
        path.write_bytes(content)
        with pytest.raises(DataError, match=r"cut\.e57"):
            read(path)
