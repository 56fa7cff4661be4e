"""`executive objects`: what a run knows of its stones, listed, as JSON and as files."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.clouds.reader import read_points
from executive.commands.main import main
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis, from_quaternion
from executive.messages.segment import Segment
from executive.messages.stone import StoneState

T_RELEASE = pose(about_axis(np.array([0.0, 0, 1]), np.pi / 2), np.array([0.0, 4.0, 0.0]))


def executive(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["executive", "objects", *map(str, words)])
    try:
        main()
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


@pytest.fixture
def run_dir(tmp_path: Path) -> Path:
    """A run's folder whose mission is still under way: the database is open."""
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "mission.yaml").write_text(
        "mission: relocate\nplugins:\n  objects: {plugin: sqlite}\n"
    )
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(str(folder / "objects.sqlite"))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (2000, 3))
    for place in ([3.0, 0, 0], [0, -5.0, 0]):
        database.observe([Segment(0, points + place, np.array(place), np.ones(3))], 1.0, True)
    database.grasp(1, np.eye(4), 2.0)
    database.release(1, T_RELEASE, 3.0, StoneState.PLACED)
    return folder


def test_people_get_a_line_a_stone(
    run_dir: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert executive(monkeypatch, run_dir) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert lines[1].split()[:2] == ["1", "placed"]
    assert lines[1].endswith("1  release at 3.0 s")
    assert lines[2].split()[:2] == ["2", "on_ground"]


def test_machines_get_poses_and_history(
    run_dir: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    assert executive(monkeypatch, run_dir, "--json") == 0
    first, second = json.loads(capsys.readouterr().out)["stones"]
    assert [event["kind"] for event in first["history"]] == ["found", "grasp", "release"]
    T_found = pose(None, np.array([3.0, 0, 0]))
    np.testing.assert_allclose(first["T_map_object"], T_RELEASE @ T_found, atol=1e-9)
    np.testing.assert_allclose(first["centroid"], [0, 7, 0], atol=0.02)
    assert (second["state"], second["seen_from_above"]) == ("on_ground", True)


def test_stones_and_poses_are_exported(
    run_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "new" / "stones"
    assert executive(monkeypatch, run_dir, "--export", folder) == 0
    assert sorted(path.name for path in folder.iterdir()) == [
        "poses.csv",
        "stone_001.ply",
        "stone_002.ply",
    ]
    np.testing.assert_allclose(
        read_points(folder / "stone_001.ply").mean(axis=0), [0, 7, 0], atol=0.02
    )
    rows = list(csv.DictReader((folder / "poses.csv").read_text().splitlines()))
    assert [(row["stone"], row["kind"]) for row in rows[:3]] == [
        ("1", "found"),
        ("1", "grasp"),
        ("1", "release"),
    ]
    assert [float(rows[2][key]) for key in ("x_m", "y_m", "z_m")] == pytest.approx([0, 7, 0])
    R = from_quaternion(np.array([float(rows[2][key]) for key in ("qw", "qx", "qy", "qz")]))
    np.testing.assert_allclose(R, T_RELEASE[:3, :3], atol=1e-8)


def test_wrong_folders_are_named(
    run_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    for words, says in (
        ([tmp_path / "nowhere"], "no such folder"),
        ([tmp_path], "holds no objects.sqlite"),
        ([run_dir, "--export", run_dir], "is not empty; name a new folder"),
    ):
        assert executive(monkeypatch, *words) == 2
        assert says in capsys.readouterr().err
    (run_dir / "mission.yaml").write_text(
        "mission: relocate\nplugins:\n  objects: {plugin: sqlit}\n"
    )
    assert executive(monkeypatch, run_dir) == 2
    assert "Did you mean 'sqlite'?" in capsys.readouterr().err
    (run_dir / "mission.yaml").write_text("mission: relocate\nplugins: {}\n")
    assert executive(monkeypatch, run_dir) == 2
    assert "mission.yaml: names no objects plugin" in capsys.readouterr().err
