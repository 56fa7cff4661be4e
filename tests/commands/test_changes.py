"""`executive changes`: a stone that left, one that came, one that moved, and those that stayed."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from executive.clouds.ply_writer import write_parts
from executive.clouds.reader import read_points
from executive.commands.main import main
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy

PLACES = {"a": (-2.0, -2.0), "b": (2.0, -1.5), "c": (0.0, 2.0), "d": (-2.0, 1.5)}
MOVED = (2.2, 1.6)


def stone(name: str, seed: int, turned_rad: float = 0.0) -> np.ndarray:
    """The surface above the ground of one of the stones, sampled anew by each seed."""
    shape, rng = np.random.default_rng(ord(name)), np.random.default_rng(seed)
    corners = shape.normal(size=(16, 3))
    corners *= shape.uniform([0.5, 0.35, 0.3], [0.6, 0.45, 0.4]) / np.linalg.norm(
        corners, axis=1, keepdims=True
    )
    hull = ConvexHull(corners)
    a, b, c = corners[hull.simplices].transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    faces = rng.choice(len(areas), 6000, p=areas / areas.sum())
    u, v = np.sort(rng.uniform(size=(2, 6000)), axis=0)
    points = u[:, None] * a[faces] + (v - u)[:, None] * b[faces] + (1 - v)[:, None] * c[faces]
    points = points @ from_rpy(0.0, 0.0, turned_rad).T + [0.0, 0.0, 0.25]
    return np.asarray(points[points[:, 2] > 0])


def site(seed: int, stones: dict[str, tuple[tuple[float, float], float]]) -> np.ndarray:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-4, 4, (60_000, 2))
    parts = [np.column_stack([xy, np.zeros(len(xy))])]
    for name, (place, turned_rad) in stones.items():
        there = stone(name, seed, turned_rad) + [*place, 0.0]
        low, high = there.min(axis=0), there.max(axis=0)
        under = ((parts[0][:, :2] > low[:2]) & (parts[0][:, :2] < high[:2])).all(axis=1)
        parts = [parts[0][~under], *parts[1:], there]
    points = np.vstack(parts)
    return np.asarray(points + rng.normal(0, 0.006, points.shape))


def changes(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["executive", "changes", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


@pytest.fixture(scope="module")
def clouds(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("changes")
    before = {name: (PLACES[name], 0.0) for name in "abc"}
    after = {"a": (PLACES["a"], 0.0), "b": (MOVED, 0.7), "d": (PLACES["d"], 0.0)}
    write_parts(folder / "before.ply", [site(1, before)])
    write_parts(folder / "after.ply", [site(2, after)])
    return folder / "before.ply", folder / "after.ply"


def places(told: list[dict]) -> list[tuple[float, float]]:
    return [(round(one["centroid"][0], 0), round(one["centroid"][1], 0)) for one in told]


def test_what_left_came_and_moved_is_told(
    clouds: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "changes.ply"
    assert changes(monkeypatch, *clouds, "--out", out, "--json") == 0
    told, spoken = capsys.readouterr()
    found = json.loads(told)
    assert places(found["went"]) == [(0.0, 2.0)]
    assert places(found["came"]) == [(-2.0, 2.0)]
    assert (found["stayed"], found["unseen"]) == (1, [])
    (one,) = found["moved"]
    T = np.array(one["T"])
    true = pose(from_rpy(0, 0, 0.7), np.zeros(3))
    true[:2, 3] = np.array(MOVED) - true[:2, :2] @ PLACES["b"]
    middle = np.array([*PLACES["b"], 0.3])
    assert np.linalg.norm(transform(T, middle) - transform(true, middle)) < 0.05
    assert "1 came, 1 went, 1 moved, 1 stayed, 0 unseen" in spoken
    assert len(read_points(out)) > 3000


def test_a_later_cloud_of_another_frame_takes_the_pose(
    clouds: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    T = pose(from_rpy(0.0, 0.0, 1.2), np.array([30.0, -20.0, 4.0]))
    write_parts(tmp_path / "moved.ply", [transform(inverse(T), read_points(clouds[0]))])
    assert changes(monkeypatch, clouds[0], tmp_path / "moved.ply") == 2
    assert "share 0 of" in capsys.readouterr().err
    (tmp_path / "pose.json").write_text(json.dumps({"T": T.tolist(), "scale": 1.0}))
    words = (clouds[0], tmp_path / "moved.ply", "--guess", tmp_path / "pose.json")
    assert changes(monkeypatch, *words) == 0
    assert "0 came, 0 went, 0 moved, 3 stayed, 0 unseen" in capsys.readouterr().err


def test_what_the_later_cloud_does_not_show_is_unseen_and_not_gone(
    clouds: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    points = read_points(clouds[0])
    away = np.hypot(*(points[:, :2] - PLACES["c"]).T) > 0.9
    write_parts(tmp_path / "hidden.ply", [points[away]])
    assert changes(monkeypatch, clouds[0], tmp_path / "hidden.ply", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert places(found["unseen"]) == [(0.0, 2.0)]
    assert (found["went"], found["came"], found["stayed"]) == ([], [], 2)


def segmented(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["executive", "segment", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_what_came_since_an_earlier_cloud_is_told_as_moving(
    clouds: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after = clouds
    assert segmented(monkeypatch, after, "--json") == 0
    assert len(json.loads(capsys.readouterr().out)["segments"]) == 3
    assert segmented(monkeypatch, after, "--earlier", before, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert places(found["segments"]) == [(-2.0, -2.0)]
    assert found["segments"][0]["id"] == 0
    assert sorted(places(found["left_out"])) == [(-2.0, 2.0), (2.0, 2.0)]
    for part in found["left_out"]:
        assert part["kind"] == "moving"
        assert part["reason"].startswith("before.ply shows lower ground at ")
    assert segmented(monkeypatch, after, "--earlier", after) == 0
    assert "moving" not in capsys.readouterr().err


def test_an_earlier_cloud_of_another_place_is_refused(
    clouds: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_parts(tmp_path / "far.ply", [read_points(clouds[0]) + [500.0, 0.0, 0.0]])
    assert segmented(monkeypatch, clouds[1], "--earlier", tmp_path / "far.ply") == 2
    told = capsys.readouterr().err
    assert f"{clouds[1]}: the clouds share 0 of" in told
    assert segmented(monkeypatch, clouds[1], "--earlier", tmp_path / "none.ply") == 2
    assert "none.ply" in capsys.readouterr().err


def test_the_answers_of_a_folder_are_of_one_earlier_cloud(
    clouds: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before, after = clouds
    folder, out = tmp_path / "clouds", tmp_path / "answers"
    folder.mkdir()
    (folder / "site.ply").write_bytes(after.read_bytes())
    for words, count in (((), 3), (("--earlier", before), 1)):
        assert segmented(monkeypatch, folder, "--out", out, *words) == 0
        assert "done before" not in capsys.readouterr().err
        assert len(json.loads((out / "site.ply.json").read_text())["segments"]) == count
