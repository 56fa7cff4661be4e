"""`executive convert`: colour, intensity and coordinate system stay with a cloud."""

import json
import struct
from pathlib import Path

import laspy
import numpy as np
import open3d as o3d
import pytest

from executive.clouds.file_cloud import FileCloud, Place
from executive.clouds.reader import read_cloud
from executive.clouds.writer import write_cloud
from executive.geometry.pose import pose_xyz_rpy, transform
from tests.commands.in_process import executive

PLACE = np.array([2_600_000.0, 1_200_000.0, 440.0])
RNG = np.random.default_rng(20)
POINTS = np.round(RNG.uniform(-4, 4, (2000, 3)), 3) + PLACE
COLOUR = 257 * RNG.integers(0, 256, (2000, 3))
INTENSITY = RNG.integers(0, 65536, 2000)
WKT = 'PROJCS["Baustelle",UNIT["metre",1]]'
KEYS = struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 2056)


def las(path: Path, number: int = 34735, content: bytes = KEYS) -> Path:
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = np.full(3, 0.001), PLACE
    data = laspy.LasData(header)
    data.xyz = POINTS
    data.red, data.green, data.blue = COLOUR.T
    data.intensity = INTENSITY
    data.header.vlrs.append(laspy.VLR("LASF_Projection", number, record_data=content))
    data.write(path)
    return path


def same(one: FileCloud, points: np.ndarray, rows: slice | np.ndarray = slice(None)) -> None:
    np.testing.assert_allclose(one.points, points, rtol=0, atol=1e-6)  # doubles at 2,600 km: 1 nm
    assert np.array_equal(one.colour_8(), (COLOUR // 257)[rows])
    assert np.array_equal(one.intensity, INTENSITY[rows])


@pytest.mark.parametrize("suffix", ["las", "laz", "ply", "pcd", "e57"])
def test_colour_intensity_and_coordinate_system_go_into_every_format_and_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, suffix: str
) -> None:
    there, back = tmp_path / f"there.{suffix}", tmp_path / "back.laz"
    assert executive(monkeypatch, "convert", las(tmp_path / "site.laz"), there, "--json") == 0
    told = capsys.readouterr()
    found = json.loads(told.out)
    assert (found["points"], found["read"], found["crs"]) == (2000, 2000, "EPSG:2056")
    assert (found["colour"], found["intensity"], found["changed"]) == (True, True, [])
    assert "left out: returns, classes, time" in told.err
    assert executive(monkeypatch, "convert", there, back) == 0
    for path in (there, back):
        same(read_cloud(path), POINTS)
        assert read_cloud(path).place.crs == "EPSG:2056"


def test_a_las_file_keeps_its_grid_and_the_bytes_of_its_coordinate_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number, content in ((34735, KEYS), (2112, WKT.encode() + b"\0")):
        site, out = las(tmp_path / "site.las", number, content), tmp_path / "out.laz"
        assert executive(monkeypatch, "convert", site, out, "--thin", 0.5) == 0
        with laspy.open(out) as file:
            header = file.header
        assert header.scales.tolist() == [0.001] * 3
        assert header.offsets.tolist() == PLACE.tolist()
        assert header.global_encoding.wkt == (number == 2112)
        (record,) = (one for one in header.vlrs if one.user_id == "LASF_Projection")
        assert record.record_id == number
        assert read_cloud(out).place.records == ((number, content),)


def test_a_crop_and_a_thinning_keep_what_belongs_to_each_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    area = f"{PLACE[0] - 1},{PLACE[1] - 2},{PLACE[0] + 3},{PLACE[1] + 1}"
    words = ("convert", las(tmp_path / "a.laz"), tmp_path / "b.ply", "--crop", area)
    assert executive(monkeypatch, *words) == 0
    local = POINTS - PLACE
    x, y, _ = local.T
    rows = np.flatnonzero((x >= -1) & (x <= 3) & (y >= -2) & (y <= 1))
    assert 0 < len(rows) < 2000
    same(read_cloud(tmp_path / "b.ply"), POINTS[rows], rows)
    assert executive(monkeypatch, *words, "--thin", 0.5) == 0
    cells = np.floor(POINTS[rows] / 0.5)
    first = np.sort(np.unique(cells, axis=0, return_index=True)[1])
    same(read_cloud(tmp_path / "b.ply"), POINTS[rows][first], rows[first])


def test_a_pose_moves_the_cloud_into_the_coordinate_system_of_its_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    T = pose_xyz_rpy(np.array([5.0, -3.0, 1.0]), np.array([0.02, 0.01, 1.2]))
    answer = tmp_path / "answer.json"
    answer.write_text(json.dumps({"T": T.tolist(), "scale": 1.5, "crs": WKT}))
    words = ("convert", las(tmp_path / "a.las"), tmp_path / "b.laz", "--pose", answer)
    assert executive(monkeypatch, *words) == 0
    found = read_cloud(tmp_path / "b.laz")
    assert found.place.crs == WKT
    # The file's step of 0.1 mm rounds by half of it.
    np.testing.assert_allclose(found.points, transform(T, 1.5 * POINTS), rtol=0, atol=5.1e-5)
    assert executive(monkeypatch, *words[:3], "--pose", "1,2,3") == 0
    assert read_cloud(tmp_path / "b.laz").place.crs == ""
    assert executive(monkeypatch, *words[:3], "--pose", "1,2,3", "--crs", "EPSG:25832") == 0
    assert read_cloud(tmp_path / "b.laz").place.crs == "EPSG:25832"


@pytest.mark.parametrize("suffix", ["ply", "pcd"])
@pytest.mark.parametrize("write_ascii", [True, False])
def test_the_colours_of_other_programs_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, write_ascii: bool
) -> None:
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(POINTS - PLACE))
    cloud.colors = o3d.utility.Vector3dVector(COLOUR / 65535)
    path = tmp_path / f"site.{suffix}"
    assert o3d.io.write_point_cloud(path, cloud, write_ascii=write_ascii)
    assert executive(monkeypatch, "convert", path, tmp_path / "out.las") == 0
    assert np.array_equal(read_cloud(tmp_path / "out.las").colour, COLOUR)


def test_shares_and_fractions_as_intensities_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 3\n"
    head += "".join(
        f"property double {name}\n" for name in ("x", "y", "z", "scalar_Intensity", "t")
    )
    for values, read, says in (
        ((0, 0.5, 1), [0, 32768, 65535], "intensities from 0 to 1 are written from 0 to 65535"),
        ((0, 7.4, 9), [0, 7, 9], "intensities are rounded to whole numbers"),
        ((0, 7, 9), [0, 7, 9], "with intensity"),
    ):
        rows = "".join(f"{i} {i} {i} {value} 9\n" for i, value in enumerate(values))
        (tmp_path / "a.ply").write_text(f"{head}end_header\n{rows}")
        assert executive(monkeypatch, "convert", tmp_path / "a.ply", tmp_path / "a.las") == 0
        told = capsys.readouterr().err
        assert says in told
        assert "left out: t\n" in told
        assert read_cloud(tmp_path / "a.las").intensity.tolist() == read


@pytest.mark.parametrize(
    ("values", "out", "options", "says"),
    [
        ("1 2 3 -4.5 10", "a.las", (), "an intensity is not within 0 to 65535"),
        ("1 2 3 nan 10", "a.laz", (), "write a PLY or PCD file"),
        ("1 2 3 nan 10", "a.e57", (), "a.e57: an intensity is not finite"),
        ("1 2 3 inf 10", "a.e57", (), "write a PLY or PCD file"),
        ("1 2 3 4 10", "a.copc.laz", (), "COPC is read, not written; write a.laz, and have PDAL"),
        ("1 2 3 4 256", "a.pcd", (), "a.ply: a value of 'red' is not within 0 to 255"),
        ("1 2 3 4 nan", "a.pcd", (), "a.ply: a value of 'red' is not within 0 to 255"),
        ("1 2 3 4 10", "a.xyz", (), "name a .ply or .pcd or .las or .laz or .e57 file"),
        ("1 2 3 4 10", "a.ply", (), "is a file that is read; name another file"),
        ("1 2 3 4 10", "a.las", ("--crop", "9,9,1"), "--crop: no point is in 9,9,1"),
        ("1 2 3 4 10", "a.las", ("--pose", "1,2"), "--pose: '1,2' holds 2 numbers"),
        ("1 2 3 4 10", "a.las", ("--crs", "EPSG:99999"), "cannot hold the code EPSG:99999"),
        ("1 2 3 4 10", "a.pcd", ("--crs", "two\nlines"), "is named by a line of ASCII"),
        ("1 2 3 4 10\n1e6 2 3 4 10", "a.las", (), "more than a LAS file holds in steps of"),
    ],
)
def test_what_cannot_be_kept_is_refused_with_a_cure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture,
    values: str, out: str, options: tuple[str, ...], says: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    rows = values.split("\n")
    Path("a.ply").write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\nproperty double x\nproperty double y\n"
        "property double z\nproperty float intensity\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nend_header\n" + "".join(f"{row} 20 30\n" for row in rows)
    )
    before = Path("a.ply").read_bytes()
    assert executive(monkeypatch, "convert", "a.ply", out, *options) == 2
    told = capsys.readouterr().err
    assert says in told, told
    assert Path("a.ply").read_bytes() == before


@pytest.mark.parametrize("suffix", ["las", "laz", "pcd", "ply", "e57"])
def test_segments_keep_the_place_of_their_cloud(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, suffix: str
) -> None:
    rng = np.random.default_rng(3)
    way = rng.normal(size=(9000, 3))
    lump = way / np.linalg.norm(way, axis=1)[:, None] * [0.5, 0.45, 0.4] + [1, -1, 0.2]
    ground = rng.uniform([-4, -4, 0], [4, 4, 0.02], (30_000, 3))
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales, header.offsets = np.full(3, 0.001), PLACE
    data = laspy.LasData(header)
    data.xyz = np.vstack([ground, lump[lump[:, 2] > 0]]) + PLACE
    data.header.vlrs.append(laspy.VLR("LASF_Projection", 34735, record_data=KEYS))
    data.write(tmp_path / "site.laz")
    out = tmp_path / f"stones.{suffix}"
    assert executive(monkeypatch, "segment", tmp_path / "site.laz", "--json", "--out", out) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["crs"] == "EPSG:2056"
    (stone,) = found["segments"]
    written = read_cloud(out)
    assert written.place.crs == "EPSG:2056"
    np.testing.assert_allclose(written.points.mean(axis=0), stone["centroid"], rtol=0, atol=1e-6)
    np.testing.assert_allclose(stone["centroid"][:2], PLACE[:2] + [1, -1], rtol=0, atol=0.05)


def test_an_alignment_is_written_as_las_in_the_place_of_its_target(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(8)
    faces = rng.uniform(-0.5, 0.5, (9000, 3))
    faces[np.arange(9000), np.arange(9000) % 3] = 0.5  # three faces of a cube hold all directions
    source, target, out = (tmp_path / name for name in ("source.ply", "target.laz", "both.laz"))
    for path, points in ((source, faces[::2] + [0.03, -0.02, 0.01]), (target, faces[1::2])):
        cloud = FileCloud(points + PLACE, place=Place("EPSG:2056"))
        write_cloud(path, cloud)
    assert executive(monkeypatch, "align", source, target, "--out", out) == 0
    both = read_cloud(out)
    assert both.place.crs == "EPSG:2056"
    assert len(both) == 9000
    assert len(np.unique(both.colour, axis=0)) == 2
    np.testing.assert_allclose(both.points.max(axis=0), PLACE + 0.5, rtol=0, atol=0.01)
