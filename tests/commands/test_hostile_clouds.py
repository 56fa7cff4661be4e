"""Each hostile cloud through each way in: a clear error, status 2, or the right answer."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import laspy
import numpy as np
import open3d as o3d
import pytest

from executive import registry
from executive.clouds.ply_writer import write_parts
from executive.commands.main import main
from executive.errors import DataError

UTM = np.array([412_000.0, 5_246_000.0, 440.0])
PLY = b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" + b"".join(
    b"property float %c\n" % axis for axis in b"xyz"
) + b"end_header\n"  # fmt: skip


def site() -> np.ndarray:
    """Four lumps on level ground, eight metres across."""
    rng = np.random.default_rng(0)
    parts = [np.column_stack([rng.uniform(-4, 4, (30_000, 2)), np.zeros(30_000)])]
    for i, place in enumerate([(2, 1), (-2, 2), (-1, -2), (2.5, -2.5)]):
        d = rng.normal(size=(5000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        lump = (
            d * (0.5 + 0.1 * np.sin(3 * d @ rng.normal(0, 1, 3)))[:, None] * [1, 0.8, 0.5 + 0.1 * i]
        )
        parts.append((lump + [*place, 0.2])[lump[:, 2] > -0.2])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.006, points.shape)


SITE = site()


def single(points: np.ndarray) -> bytes:
    return PLY % len(points) + points.astype("<f4").tobytes()


def swapped(points: np.ndarray) -> bytes:
    return points.astype(">f4").tobytes()


def las(path: Path) -> None:
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales, header.offsets = np.full(3, 0.001), UTM
    data = laspy.LasData(header)
    data.xyz = SITE + UTM
    data.write(path)


def cut(path: Path) -> None:
    las(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def pcd(path: Path) -> None:
    assert o3d.io.write_point_cloud(
        path, o3d.geometry.PointCloud(o3d.utility.Vector3dVector(SITE)), compressed=True
    )
    path.write_bytes(path.read_bytes()[:-5000])


REFUSED: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "truncated PLY": ("a.ply", lambda p: p.write_bytes(single(SITE)[:-1000]), "cut short"),
    "truncated PCD": ("a.pcd", pcd, "cut short"),
    "truncated LAS": ("a.las", cut, "cut short"),
    "truncated LAZ": ("a.laz", cut, "cut short"),
    "a claim of 4e9 "
"points": ("a.ply", lambda p: p.write_bytes(PLY % 4_000_000_000 + bytes(9999)), "cut short"),
    "nothing finite": ("a.ply", lambda p: p.write_bytes(single(SITE * np.nan)), "points is finite"),
    "empty file": ("a.ply", lambda p: p.write_bytes(b""), "lacks a header"),
    "empty cloud": ("a.ply", lambda p: p.write_bytes(PLY % 0), "holds no points"),
    "one point": ("a.xyz", lambda p: p.write_text("1 2 3\n"), "|too small for a site|1 points, at "
"least "
"100"),
    "single precision in "
"UTM": ("a.ply", lambda p: p.write_bytes(single(SITE + UTM)), "in steps of 0.5 m"),
    "millimetres": ("a.ply", lambda p: p.write_bytes(single(1000 * SITE)), "in millimetres it "
"would "
"be "
"8"),
    "UTF-16": ("a.xyz", lambda p: p.write_bytes("1 2 3\n".encode("utf-16")), "UTF-16"),
    "binary called text": ("a.xyz", lambda p: p.write_bytes(SITE.tobytes()), "not lines of"),
    "another byte "
"order": ("a.ply", lambda p: p.write_bytes(PLY % len(SITE) + swapped(SITE)), "is beyond"),
    "a picture": ("a.jpg", lambda p: p.write_bytes(os.urandom(99)), "not a supported cloud format"),
}  # fmt: skip


def executive(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["executive", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def survey(path: Path) -> np.ndarray:
    plugin = registry.load("surveying", "point_cloud_file")
    return plugin(plugin.Settings(path=path)).survey(np.random.default_rng(0)).points


def says(words: str, text: str) -> bool:
    return any(part in text for part in words.split("|") if part)


@pytest.mark.parametrize("what", REFUSED)
def test_a_hostile_cloud_is_refused_by_every_way_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, what: str
) -> None:
    name, make, words = REFUSED[what]
    hostile, good = tmp_path / name, tmp_path / "good.ply"
    make(hostile)
    write_parts(good, [SITE])
    for verb in (
        ["segment", hostile],
        ["register", hostile, good],
        ["register", good, hostile],
        ["align", hostile, good],
    ):
        assert executive(monkeypatch, *verb) == 2
        said = capsys.readouterr().err
        assert says(words, said), said
        assert name in said
    with pytest.raises(DataError) as refusal:
        survey(hostile)
    assert says(words, str(refusal.value)), refusal.value


def segments(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, path: Path) -> list:
    capsys.readouterr()
    assert executive(monkeypatch, "segment", path, "--json") == 0
    return json.loads(capsys.readouterr().out)["segments"]


@pytest.mark.parametrize("what", ["holes", "repeated", "UTM in double precision", "UTM in LAZ"])
def test_a_strange_but_whole_cloud_is_read_right(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, what: str
) -> None:
    good, strange = (
        tmp_path / "good.ply",
        tmp_path / ("strange.laz" if "LAZ" in what else "strange.ply"),
    )
    offset = UTM if "UTM" in what else np.zeros(3)
    write_parts(good, [SITE])
    if "LAZ" in what:
        las(strange)
    else:
        before = {"holes": [np.full((999, 3), np.nan)], "repeated": [SITE, SITE]}.get(what, [])
        write_parts(strange, [*before, SITE + offset])
    expected, found = (segments(monkeypatch, capsys, path) for path in (good, strange))
    assert len(found) == len(expected) == 4
    for one, other in zip(expected, found, strict=True):
        # 3 cm: rounding, and a grid that lies otherwise, move points at the edge of a stone.
        np.testing.assert_allclose(np.array(other["centroid"]) - offset, one["centroid"], atol=0.03)
        assert other["points"] == pytest.approx(one["points"], rel=0.05)
    assert (
        executive(monkeypatch, "align", strange, good, "--guess", ",".join(map(str, -offset))) == 0
    )
    assert executive(monkeypatch, "register", strange, good) == 0
    assert np.allclose(np.ptp(survey(strange), axis=0), np.ptp(SITE, axis=0), atol=0.03)
