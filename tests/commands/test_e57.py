"""E57 files through the command line: scans with poses, colours, and damage of every kind."""

import json
from pathlib import Path

import numpy as np
import pytest

from executive import extras
from executive.clouds.reader import read_cloud, read_points
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
