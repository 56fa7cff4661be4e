"""The verb `place` apart: trials are told, written and judged."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from executive.commands.walls import place as place_verb
from executive.errors import ConfigError


def test_a_trial_is_told_written_and_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    last = SimpleNamespace(detail="4 places slip")
    trial = SimpleNamespace(reason="nothing_fits", placed=["one"], last=last, built="the wall")
    asked: list[Any] = []

    def built(*given: Any) -> Any:
        asked.append(given)
        return trial, {"open.obj": "left out"}

    monkeypatch.setattr(place_verb, "_built", built)
    monkeypatch.setattr(
        "executive.commands.walls.construction.answer_of", lambda one: {"right": 1, "a": one.reason}
    )
    monkeypatch.setattr(
        "executive.mission.judging.verdict_of", lambda one, name: {"stands": 0.5, "n": 3}
    )
    monkeypatch.setattr("executive.registry.names", lambda group: ("a_judge",))
    drawn: list[Any] = []

    def draw(*given: Any) -> list[str]:
        drawn.append(given)
        return ["course_1.png"]

    drawing = SimpleNamespace(draw_courses=draw)
    monkeypatch.setitem(sys.modules, "executive.commands.walls.pictures", drawing)
    out = tmp_path / "a.json"
    words = Path("stones"), Path("wall.yaml"), "mine", ["building.x=1"], 2.5, out, tmp_path
    with pytest.raises(typer.Exit) as ended:
        place_verb.place(*words, "a_judge", 5, True)
    assert ended.value.exit_code == 0
    ((stones, wall, options, budget, seed),) = asked
    assert (stones, wall, budget, seed) == (Path("stones"), Path("wall.yaml"), 2.5, 5)
    assert set(options) == {"building.x=1", "building.plugin=mine"}
    assert drawn == [(tmp_path, ["one"], 4)]
    told = capsys.readouterr()
    answered = {
        "seed": 5, "left_out": {"open.obj": "left out"}, "right": 1, "a": "nothing_fits",
        "verdict": {"stands": 0.5, "n": 3},
    }  # fmt: skip
    assert json.loads(told.out) == json.loads(out.read_text()) == answered
    assert told.err.splitlines() == [
        "ended: nothing_fits; 1 stones, 1 where planned",
        "  4 places slip",
        f"  {'stands':26} 0.500",
        f"  {'n':26} 3",
        "  course_1.png",
    ]
    drawn.clear()
    trial.placed, trial.last = [], None
    with pytest.raises(typer.Exit) as ended:
        place_verb.place(*words, "a_judge", 5, False)
    assert ended.value.exit_code == 1
    assert drawn == []
    told = capsys.readouterr()
    assert (told.out, told.err) == ("", "ended: nothing_fits; 0 stones, 1 where planned\n")
    assert "verdict" not in json.loads(out.read_text())


def test_pictures_need_a_folder_that_is_there(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"--pictures: .*none: name a folder that exists"):
        place_verb.place(Path("stones"), Path("wall.yaml"), pictures=tmp_path / "none")


def test_a_judge_that_is_not_there_is_refused_before_anything_is_built(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(place_verb, "_built", lambda *given: pytest.fail("it was built"))
    with pytest.raises(ConfigError, match=r"--judge: 'rigid_stone' is unknown\. Did you mean 'rig"):
        place_verb.place(Path("stones"), Path("wall.yaml"), judge="rigid_stone")
