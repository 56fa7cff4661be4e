"""`executive place`, from the front door."""

import json
import sys
from pathlib import Path

import pytest

from executive.commands.main import main
from executive.commands.walls.wall_of_mission import wall_of_mission
from executive.testing.exercises.building import box
from executive.tree.load import load_mission
from executive.tree.traversal import uses_of

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


OWN_SCORER = """
import numpy as np

class Light:
    def __init__(self, settings):
        self.weights = settings.weights

    def score(self, places, built, inventory):
        return {"light": np.full(len(places.origins_map), -places.stone.mass_kg)}
"""


@pytest.mark.parametrize(
    ("part", "first"), [("weighted", "1.obj"), ("walls_of_mine:Light", "0.obj")]
)
def test_a_scorer_of_a_user_changes_which_stone_is_first(
    part: str, first: str, stones: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "walls_of_mine.py").write_text(OWN_SCORER, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    larger = (stones / "1.obj").read_text(encoding="utf-8").replace("0.4 ", "0.45 ")
    (stones / "1.obj").write_text(larger, encoding="utf-8")
    wall, out = tmp_path / "wall.yaml", tmp_path / "out.json"
    # By its volume alone: the larger stone is longer, too.
    unchecked = (
        "{plugin: dry_stone, check: {part: none}, generator: {sides: 1, turns: 2}, "
        "scorer: {weights: {into: 0}}}"
    )
    wall.write_text(WALL.replace("{plugin: side_by_side}", unchecked), encoding="utf-8")
    words = stones, wall, "--out", out, "--judge", "none", "--set", f"building.scorer.part={part}"
    assert place(monkeypatch, *words) == 0
    assert json.loads(out.read_text(encoding="utf-8"))["placed"][0]["stone"] == first


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


def test_a_wall_of_a_mission_is_laid_over_its_settings(tmp_path: Path) -> None:
    wall = tmp_path / "wall.yaml"
    wall.write_text(
        "line: [[0 m, 6 m], [1 m, 6 m]]\nheight: 0.4 m\nnoise: 1 cm\n"
        "building: {check: {samples: 2}, plugin: dry_stone}\n"
    )
    settings, unused = wall_of_mission(wall)
    mission = load_mission("build_wall", settings)
    planner = mission.plugins["building"][0].settings
    assert (planner.check.samples, planner.generator.attitude) == (2, "kept")
    assert unused == ["noise"]
    (described,) = (use for node in mission.trees["the_wall"].root.walk() for use in uses_of(node))
    assert described.settings.shaped("low").height_m == 0.4
