"""`executive place`, from the front door."""

import json
import sys
from pathlib import Path

import pytest

from executive.commands.main import main
from executive.testing.exercises.building import box

WALL = """
structure: low wall
line: [[-1 m, 0 m], [1 m, 0 m]]
thickness: 0.9 m
height: 0.5 m
building: {plugin: side_by_side}
"""


@pytest.fixture
def stones(tmp_path: Path) -> Path:
    folder = tmp_path / "stones"
    folder.mkdir()
    for number in range(2):
        stone = box("one", 0.8, 0.6, 0.4)
        lines = [f"v {x} {y} {z}" for x, y, z in stone.vertices]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in stone.triangles]
        (folder / f"{number}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "open.obj").write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
    return folder


def place(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["executive", "place", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_two_boxes_are_placed_and_the_open_mesh_is_told(
    stones: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wall, out = tmp_path / "wall.yaml", tmp_path / "out.json"
    wall.write_text(WALL, encoding="utf-8")
    words = stones, wall, "--out", out, "--judge", "none", "--pictures", tmp_path
    assert place(monkeypatch, *words) == 0
    told = json.loads(out.read_text(encoding="utf-8"))
    assert [one["is_right"] for one in told["placed"]] == [True, True]
    assert told["ended"] == "no_stones"
    assert "not closed" in told["left_out"]["open.obj"]
    assert (tmp_path / "course_1.png").stat().st_size > 1000


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (WALL.replace("height: 0.5 m", "hieght: 0.5 m"), "wall.yaml:5:1: error"),
        (WALL + "ring: {radius: 1 m}\n", "one of line, ring, cairn"),
        (WALL.replace("side_by_side", "side_by_sied"), "Did you mean 'side_by_side'"),
        (WALL + "batter: 45 deg\n", "faces meet below its top"),
    ],
)
def test_a_wrong_file_is_refused_with_its_place(
    stones: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    text: str,
    told: str,
) -> None:
    (tmp_path / "wall.yaml").write_text(text, encoding="utf-8")
    assert place(monkeypatch, stones, tmp_path / "wall.yaml", "--judge", "none") == 2
    assert told in capsys.readouterr().err
