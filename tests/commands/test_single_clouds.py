"""`executive segment` and `executive register` on files that are whole, foreign, hostile, or not
there.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import open3d as o3d
import pytest

from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.ply_writer import write_parts
from executive.clouds.reader import read_points
from executive.commands.main import main
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, from_rpy

T_TRUE = pose(from_rpy(0.02, -0.03, 1.1), np.array([6.0, -4.0, 2.0]))


def executive(*words: object) -> subprocess.CompletedProcess:
    code = (
        f"import sys; sys.argv = ['executive', *{[str(w) for w in words]!r}]; from "
        "executive.commands.main import main; main()"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)


def site(sampling_seed: int) -> np.ndarray:
    """Five lumps on waves of ground, ten metres across."""
    shape, rng = np.random.default_rng(1), np.random.default_rng(sampling_seed)
    xy = rng.uniform(-5, 5, (50_000, 2))
    parts = [np.column_stack([xy, 0.04 * np.sin(xy[:, 0])])]
    for i in range(5):
        d = rng.normal(size=(8000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        waves, squeeze = shape.normal(0, 2, (3, 3)), shape.uniform(0.6, 1.0, 3)
        lump = d * (0.6 * (1 + 0.12 * np.sin(d @ waves).sum(axis=1)))[:, None] * squeeze
        angle, distance = 1.2566 * i + shape.uniform(-0.3, 0.3), shape.uniform(1.8, 4.0)
        lump += [distance * np.cos(angle), distance * np.sin(angle), 0.25]
        parts.append(lump[lump[:, 2] > 0])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.008, points.shape)


def write(path: Path, points: np.ndarray) -> Path:
    if path.suffix == ".ply":
        write_parts(path, [points])
    else:
        assert o3d.io.write_point_cloud(
            path, o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
        )
    return path


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("clouds") / "target.ply", site(2))


def test_segments_are_listed_and_written(target: Path, tmp_path: Path) -> None:
    ended = executive("segment", target, "--json", "--out", tmp_path / "parts.ply")
    assert ended.returncode == 0, ended.stderr
    segments = json.loads(ended.stdout)["segments"]
    assert [s["id"] for s in segments] == list(range(5))
    assert len(read_points(tmp_path / "parts.ply")) == sum(s["points"] for s in segments)
    written = o3d.io.read_point_cloud(str(tmp_path / "parts.ply"))
    assert len(np.unique(np.asarray(written.colors), axis=0)) == 5


def segmented(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: object
) -> tuple[int, str, str]:
    """Run `executive segment` in this process: its status, output and messages."""
    monkeypatch.setattr(sys, "argv", ["executive", "segment", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    return int(ended.value.code or 0), told.out, told.err


def test_the_coordinate_system_stays_with_the_segments(
    target: Path, tmp_path: Path, capsys, monkeypatch
) -> None:
    national = tmp_path / "site.ply"
    write_parts(national, [site(2) + [2_600_000.0, 1_200_000.0, 440.0]], "EPSG:2056")
    out = tmp_path / "parts.ply"
    _, told, _ = segmented(monkeypatch, capsys, national, "--json", "--out", out)
    assert json.loads(told)["crs"] == "EPSG:2056"
    assert coordinate_system(out) == "EPSG:2056"
    _, told, _ = segmented(monkeypatch, capsys, target, "--json", "--out", out)
    assert json.loads(told)["crs"] == ""
    assert coordinate_system(out) == ""


def test_a_crop_is_looked_at_alone(target: Path, capsys, monkeypatch) -> None:
    whole = json.loads(segmented(monkeypatch, capsys, target, "--json")[1])["segments"]
    x, y, _ = whole[0]["centroid"]
    status, out, _ = segmented(monkeypatch, capsys, target, "--json", "--crop", f"{x},{y},1.3")
    (one,) = json.loads(out)["segments"]
    assert status == 0
    np.testing.assert_allclose(one["centroid"], whole[0]["centroid"], atol=0.03)
    box = f"{x - 1.3},{y - 1.3},{x + 1.3},{y + 1.3}"
    (other,) = json.loads(segmented(monkeypatch, capsys, target, "--json", "--crop", box)[1])[
        "segments"
    ]
    np.testing.assert_allclose(other["centroid"], whole[0]["centroid"], atol=0.03)


@pytest.mark.parametrize("words", ["1,2", "1,2,-3", "3,3,1,1", "here", ""])
def test_a_crop_without_an_area_is_refused(target: Path, capsys, monkeypatch, words: str) -> None:
    status, _, told = segmented(monkeypatch, capsys, target, "--crop", words)
    assert status == 2
    assert "x,y,radius" in told


def test_a_crop_beside_the_cloud_says_where_the_cloud_is(target: Path, capsys, monkeypatch) -> None:
    status, _, told = segmented(monkeypatch, capsys, target, "--crop", "900,0,5")
    assert status == 2
    assert "no point is in 900,0,5; the cloud has x from -5" in told


def test_a_folder_is_gone_on_with_and_what_cannot_be_used_is_told(
    target: Path, tmp_path: Path, capsys, monkeypatch
) -> None:
    folder, out = tmp_path / "clouds", tmp_path / "answers"
    folder.mkdir()
    (folder / "a.ply").write_bytes(target.read_bytes())
    (folder / "b.xyz").write_text("1 2 3\n")
    (folder / "notes.md").write_text("no cloud")
    status, _, told = segmented(monkeypatch, capsys, folder, "--out", out)
    assert status == 1
    assert "b.xyz: cannot be used" in told
    assert "1 of 2 clouds" in told
    first = json.loads((out / "a.ply.json").read_text())
    assert len(first["segments"]) == 5
    assert len(read_points(out / "a.ply.segments.ply")) == sum(
        s["points"] for s in first["segments"]
    )
    (folder / "b.xyz").write_bytes((folder / "a.ply").read_bytes())
    status, _, told = segmented(monkeypatch, capsys, folder, "--out", out)
    assert status == 0
    assert "a.ply: done before (1 of 2)" in told
    assert sorted(path.name for path in out.glob("*.json")) == ["a.ply.json", "b.xyz.json"]
    other = ("--set", "segmentation.max_extent_m=0.9")
    status, _, told = segmented(monkeypatch, capsys, folder, "--out", out, *other)
    assert "done before" not in told  # other options, another answer
    assert len(json.loads((out / "a.ply.json").read_text())["segments"]) < 5
    (out / "a.ply.json").write_text("cut sho")
    assert "b.xyz: done before" in segmented(monkeypatch, capsys, folder, "--out", out, *other)[2]
    assert "left_out" in json.loads((out / "a.ply.json").read_text())


def test_a_folder_needs_another_for_its_answers(tmp_path: Path, capsys, monkeypatch) -> None:
    status, _, told = segmented(monkeypatch, capsys, tmp_path)
    assert status == 2
    assert "name another folder" in told
    out = tmp_path / "answers"
    status, _, told = segmented(monkeypatch, capsys, tmp_path, "--out", out, "--json")
    assert status == 2
    assert "are files in the folder of --out" in told
    status, _, told = segmented(monkeypatch, capsys, tmp_path, "--out", out)
    assert status == 2
    assert "holds no cloud" in told


def test_what_is_left_out_is_told_and_nothing_to_use_is_status_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(0)
    ground = rng.uniform([-5, -5, 0], [5, 5, 0.02], (40_000, 3))
    wall = rng.uniform([-3, 2, 0], [3, 2.02, 1.5], (9000, 3))
    path = write(tmp_path / "wall.ply", np.vstack([ground, wall]))
    monkeypatch.setattr(sys, "argv", ["executive", "segment", str(path), "--json"])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    assert ended.value.code == 1
    assert "left out: " in told.err
    assert "nothing to use: no stone was found" in told.err
    (rest,) = json.loads(told.out)["left_out"]
    assert rest["kind"] in ("too_large", "structure")
    assert rest["points"] > 8000


@pytest.mark.parametrize("method", ["segment_shot", "segment_fpfh"])
def test_a_pcd_is_registered_with_a_ply_and_merged(
    target: Path, tmp_path: Path, method: str
) -> None:
    source = write(tmp_path / "source.pcd", transform(inverse(T_TRUE), site(3)))
    ended = executive(
        "register", source, target, "--method", method, "--json", "--out", tmp_path / "both.ply"
    )
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout)
    assert found["accepted"]
    assert angle_between(np.array(found["T"])[:3, :3], T_TRUE[:3, :3]) < np.radians(1)
    assert {"reason", "rmse_m", "overlap", "matched_segments", "scale"} <= set(found)
    assert found["timings_ms"]["total"] > 0
    assert len(read_points(tmp_path / "both.ply")) == len(read_points(source)) + len(
        read_points(target)
    )


def test_a_refusal_has_status_1_and_a_reason(target: Path, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    bare = np.column_stack([rng.uniform(-5, 5, (20_000, 2)), rng.normal(0, 0.01, 20_000)])
    ended = executive(
        "register",
        write(tmp_path / "bare.ply", bare),
        target,
        "--json",
        "--out",
        tmp_path / "no.ply",
    )
    assert ended.returncode == 1
    assert not json.loads(ended.stdout)["accepted"]
    assert "too few stones in view" in ended.stderr
    assert not (tmp_path / "no.ply").exists()


CLAIM = b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n" + b"".join(
    b"property float %c\n" % axis for axis in b"xyz"
)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        (
            "claim.ply",
            CLAIM + b"end_header\n" + b"\0" * 1200,
            "cut short: the header promises 4000000000 points",
        ),
        ("empty.ply", b"", "lacks a header"),
        ("nan.xyz", b"nan 2 3\n1 nan 6\n", "none of its 2 points is finite"),
        ("one.xyz", b"1 2 3\n", "0 m across is too small for a site"),
        ("same.xyz", b"1 2 3\n" * 500, "0 m across is too small for a site"),
        (
            "few.xyz",
            b"1 2 3\n4 5 6\n",
            "few.xyz: a cloud of 2 points has no ground to find; at least 60: take more of the "
            "site, or a denser cloud",
        ),
        ("photo.jpg", b"\xff\xd8", "not a supported cloud format"),
    ],
)
def test_hostile_clouds_are_a_message_and_status_2(
    tmp_path: Path, name: str, content: bytes, says: str
) -> None:
    (tmp_path / name).write_bytes(content)
    ended = executive("segment", tmp_path / name)
    assert ended.returncode == 2, ended.stderr
    assert says in ended.stderr
    assert name in ended.stderr
    assert "Traceback" not in ended.stderr


def test_a_cloud_in_millimetres_is_named(target: Path, tmp_path: Path) -> None:
    source = write(tmp_path / "mm.ply", 1000 * site(3))
    ended = executive("register", source, target)
    assert ended.returncode == 2
    assert "in millimetres it would be 10" in ended.stderr


def test_a_truncated_cloud_is_refused(target: Path, tmp_path: Path) -> None:
    (tmp_path / "cut.ply").write_bytes(target.read_bytes()[:-1000])
    ended = executive("register", tmp_path / "cut.ply", target)
    assert ended.returncode == 2
    assert "cut.ply: cut short" in ended.stderr


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--method", "segment_shott"], "Did you mean 'segment_shot'?"),
        (["--out", "no/such/place.ply"], "--out: "),
    ],
)
def test_wrong_options_are_named(target: Path, words: list[str], says: str) -> None:
    ended = executive("register", target, target, *words)
    assert ended.returncode == 2
    assert says in ended.stderr
