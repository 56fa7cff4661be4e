"""E57 files through the command line: scans with poses, colours, and damage of every kind."""

import json
from pathlib import Path

import numpy as np
import pye57
import pytest
from pye57 import libe57

from executive import extras
from executive.clouds import e57_writer
from executive.clouds.e57 import e57_crs
from executive.clouds.file_cloud import FileCloud, Place
from executive.clouds.reader import read_cloud, read_points
from executive.clouds.writer import write_cloud
from executive.geometry.rotation import from_rpy
from tests.clouds.e57_files import COLOURS, Scan, mended, write_e57
from tests.commands.in_process import executive

LV95 = 'PROJCS["CH1903+ / LV95",AUTHORITY["EPSG","2056"]]'
PLACE = np.array([2_600_000.0, 1_200_000.0, 440.0])
YAW = 0.7
TURNED = (np.cos(YAW / 2), 0.0, 0.0, np.sin(YAW / 2))
RNG = np.random.default_rng(57)
LOCAL = np.round(RNG.uniform(-4, 4, (3000, 3)), 4)
COLOUR = RNG.integers(0, 256, (3000, 3))
INTENSITY = RNG.random(3000).astype(np.float32)


def cartesian(points: np.ndarray) -> dict[str, np.ndarray]:
    return dict(zip(("cartesianX", "cartesianY", "cartesianZ"), points.T, strict=True))


def carried(rows: slice, most: int = 255) -> dict[str, np.ndarray]:
    colour = COLOUR[rows] * (most // 255)
    return {**dict(zip(COLOURS, colour.T, strict=True)), "intensity": INTENSITY[rows]}


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Two scans of one site from two stations; the second has points without a return."""
    first, second = slice(0, 1000), slice(1000, 3000)
    lost = np.arange(2000) % 4 == 0
    scans = [
        Scan(cartesian(LOCAL[first]) | carried(first), TURNED, PLACE),
        Scan(
            cartesian(LOCAL[second]) | carried(second) | {"cartesianInvalidState": 2.0 * lost},
            (1, 0, 0, 0),
            PLACE,
        ),
    ]
    return write_e57(tmp_path / "site.e57", scans, LV95)


def test_scans_are_placed_by_their_poses_with_colour_intensity_and_coordinate_system(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture,
    caplog: pytest.LogCaptureFixture,
) -> None:  # fmt: skip
    out = tmp_path / "out.ply"
    assert executive(monkeypatch, "convert", site, out, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["points"], found["crs"], found["left_out"]) == (2500, "EPSG:2056", [])
    assert "500 of 3000 points are not finite and are left out" in caplog.text
    kept = np.concatenate([np.arange(1000), 1000 + np.flatnonzero(np.arange(2000) % 4)])
    turned = np.vstack([LOCAL[:1000] @ from_rpy(0, 0, YAW).T, LOCAL[1000:]]) + PLACE
    cloud = read_cloud(out)
    np.testing.assert_allclose(cloud.points, turned[kept], rtol=0, atol=2e-9)  # doubles: 0.5 nm
    assert np.array_equal(cloud.colour, COLOUR[kept])
    assert np.array_equal(cloud.intensity, INTENSITY[kept])
    assert cloud.place.crs == "EPSG:2056"


def test_ranges_and_angles_are_points(tmp_path: Path) -> None:
    distance = np.linalg.norm(LOCAL, axis=1)
    angles = {
        "sphericalRange": distance,
        "sphericalAzimuth": np.arctan2(LOCAL[:, 1], LOCAL[:, 0]),
        "sphericalElevation": np.arcsin(LOCAL[:, 2] / distance),
    }
    path = write_e57(tmp_path / "a.e57", [Scan(angles, (1, 0, 0, 0), PLACE)])
    np.testing.assert_allclose(read_points(path), LOCAL + PLACE, rtol=0, atol=2e-9)


def test_whole_steps_and_colours_of_16_bits_are_read(tmp_path: Path) -> None:
    scan = Scan(cartesian(LOCAL) | carried(slice(None), 65535), most=65535)
    cloud = read_cloud(write_e57(tmp_path / "a.e57", [scan], in_steps=True))
    np.testing.assert_allclose(cloud.points, LOCAL, rtol=0, atol=1e-9)
    assert np.array_equal(cloud.colour, COLOUR * 257)
    assert cloud.place.crs == ""


def test_what_only_one_scan_has_is_left_out_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    scans = [Scan(cartesian(LOCAL[:9]) | carried(slice(0, 9))), Scan(cartesian(LOCAL[9:]))]
    path = write_e57(tmp_path / "a.e57", scans)
    assert executive(monkeypatch, "convert", path, tmp_path / "a.pcd", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["left_out"] == ["colorBlue", "colorGreen", "colorRed", "intensity"]
    assert not found["colour"]


def test_segment_reads_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    rng = np.random.default_rng(3)
    way = rng.normal(size=(9000, 3))
    lump = way / np.linalg.norm(way, axis=1)[:, None] * [0.5, 0.45, 0.4] + [1, -1, 0.2]
    ground = rng.uniform([-4, -4, 0], [4, 4, 0.02], (30_000, 3))
    points = np.vstack([ground, lump[lump[:, 2] > 0]])
    path = write_e57(tmp_path / "a.e57", [Scan(cartesian(points), (1, 0, 0, 0), PLACE)], LV95)
    assert executive(monkeypatch, "segment", path, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["crs"] == "EPSG:2056"
    (stone,) = found["segments"]
    np.testing.assert_allclose(stone["centroid"][:2], PLACE[:2] + [1, -1], rtol=0, atol=0.05)


def counted(content: bytes, number: int) -> bytes:
    """Return a file that promises another number of points in its first scan."""
    before, after = b'recordCount="1000">' + b"\n" + 8 * b" ", b'recordCount="%d">' % number
    assert before in content
    return mended(content.replace(before, after.ljust(len(before)), 1))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda c: c[:-2000], "its header promises"),
        (lambda c: c[:20], "it has no E57 header"),
        (lambda c: c[:40] + (4096).to_bytes(8, "little") + c[48:], "pages have 4096 bytes"),
        (lambda c: c[:24] + b"\xff" * 7 + b"\x7f" + c[32:], "bytes of XML at byte 9223372036"),
        (lambda c: c[:32] + b"\xff" * 7 + b"\x7f" + c[40:], "promises 9223372036"),
        (lambda c: c[:3000] + bytes([c[3000] ^ 1]) + c[3001:], "cut short or damaged"),
        (lambda c: mended(c.replace(b"<e57Root", b"<!ENTITY")), "is no XML as E57 files have it"),
        (lambda c: mended(c.replace(b'"UTF-8"', b'"UTF-7"')), "is no XML as E57 files have it"),
        (lambda c: counted(c, 999_999_999), "1000001999 points are more than 5e+08"),
        (lambda c: counted(c, 400_000_000), "cut short"),
    ],
    ids=["cut", "stub", "page", "at", "long", "bit", "entity", "coding", "billion", "count"],
)
def test_damage_is_refused_by_name(
    site: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, change, says: str
) -> None:
    content = site.read_bytes()
    assert mended(content) == content
    path = site.with_name("a.e57")
    path.write_bytes(change(content))
    assert path.read_bytes() != content
    assert executive(monkeypatch, "segment", path) == 2
    told = capsys.readouterr().err
    assert says in told, told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    ("scan", "says"),
    [
        (Scan(cartesian(LOCAL), (2, 0, 0, 0)), "pose of scan 0 is none (a quaternion of length 2)"),
        (Scan(cartesian(LOCAL), (0, 0, 0, 0)), "a quaternion of length 0"),
        (Scan({"intensity": INTENSITY}), "scan 0 has no coordinates, but intensity"),
        (Scan(cartesian(LOCAL * np.nan)), "none of its 3000 points is finite"),
    ],
)
def test_scans_without_a_place_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture,
    scan: Scan, says: str,
) -> None:  # fmt: skip
    path = write_e57(tmp_path / "a.e57", [scan])
    assert executive(monkeypatch, "convert", path, tmp_path / "a.ply") == 2
    assert says in capsys.readouterr().err


def test_without_its_package_the_cure_is_told(
    site: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    is_there = extras._is_installed
    monkeypatch.setattr(extras, "_is_installed", lambda name: name != "pye57" and is_there(name))
    assert executive(monkeypatch, "segment", site) == 2
    assert 'pip install "executive[e57]"' in capsys.readouterr().err


def test_what_is_written_is_read_again_to_the_bit(tmp_path: Path) -> None:
    points, names = LOCAL + PLACE + 1e-7, ("a.e57", "b.e57", "c.e57")
    for colour in (COLOUR.astype(np.uint8), (COLOUR * 257 + 1 & 0xFFFF).astype(np.uint16)):
        cloud = FileCloud(points, colour, INTENSITY * -3e4, Place("EPSG:2056"))
        assert [write_cloud(tmp_path / name, cloud) for name in names] == [(), (), ()]
        found = read_cloud(tmp_path / "a.e57")
        assert np.array_equal(found.points, points)
        assert np.array_equal(found.colour, colour)
        assert found.colour.dtype == colour.dtype
        assert np.array_equal(found.intensity, INTENSITY * np.float32(-3e4))
        assert (found.place.crs, found.left_out) == ("EPSG:2056", ())
        assert len({(tmp_path / name).read_bytes() for name in names}) == 1


def test_other_programs_find_limits_and_points_of_one_scan(tmp_path: Path) -> None:
    cloud = FileCloud(LOCAL + PLACE, COLOUR.astype(np.uint8), INTENSITY)
    write_cloud(tmp_path / "a.e57", cloud)
    with pye57.E57(str(tmp_path / "a.e57")) as file:
        assert file.scan_count == 1
        header = file.get_header(0)
        read = file.read_scan(0, intensity=True, colors=True, ignore_missing_fields=True)
        limits = header["colorLimits"]
        ends = (header.xMinimum, header.zMaximum, header.intensityMinimum, header.intensityMaximum)
        assert limits["colorGreenMaximum"].value() == 255
    low, high = cloud.points.min(axis=0), cloud.points.max(axis=0)
    assert ends == (low[0], high[2], INTENSITY.min(), INTENSITY.max())
    assert np.array_equal(read["cartesianY"], cloud.points[:, 1])
    assert np.array_equal(read["colorBlue"], COLOUR[:, 2])
    assert np.array_equal(read["intensity"], INTENSITY)


def test_a_cloud_of_one_point_without_colour_is_written(tmp_path: Path) -> None:
    write_cloud(tmp_path / "a.e57", FileCloud(PLACE[None], intensity=np.float32([7.0])))
    found = read_cloud(tmp_path / "a.e57")
    assert (found.points.tolist(), found.intensity.tolist()) == ([PLACE.tolist()], [7.0])
    assert found.colour is None
    assert found.place.crs == ""


def test_the_text_of_a_coordinate_system_is_what_a_las_file_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for records, text in (
        (((2112, f"{LV95}\n\0".encode()),), LV95),
        (((2112, b"\1" + LV95.encode()),), "EPSG:2056"),  # no text that XML can hold
        ((), "EPSG:2056"),
    ):
        cloud = FileCloud(LOCAL + PLACE, place=Place("EPSG:2056", records))
        write_cloud(tmp_path / "a.e57", cloud)
        assert e57_crs(tmp_path / "a.e57") == text
        assert read_cloud(tmp_path / "a.e57").place.crs == "EPSG:2056"


def test_a_file_that_the_library_cannot_write_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, site: Path
) -> None:
    def refuse(*given: object) -> None:
        raise libe57.E57Exception("the disk is full")

    monkeypatch.setattr(e57_writer, "_write", refuse)
    assert executive(monkeypatch, "convert", site, tmp_path / "out.e57") == 2
    assert "out.e57: cannot be written (the disk is full)" in capsys.readouterr().err
    assert not (tmp_path / "out.e57").exists()


def test_without_its_package_no_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    write_cloud(tmp_path / "a.ply", FileCloud(LOCAL))
    is_there = extras._is_installed
    monkeypatch.setattr(extras, "_is_installed", lambda name: name != "pye57" and is_there(name))
    assert executive(monkeypatch, "convert", tmp_path / "a.ply", tmp_path / "a.e57") == 2
    assert 'pip install "executive[e57]"' in capsys.readouterr().err
    assert not (tmp_path / "a.e57").exists()
