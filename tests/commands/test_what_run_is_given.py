"""What the options of `executive run` say of the mission's wall, stones and machine."""

import json
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from executive.commands.missions import resume, run
from executive.commands.walls import wall_of_mission
from executive.mission import preset_answers, selections
from executive.mission import resume as resuming
from executive.mission import run as running
from executive.tree import load
from tests.commands.in_process import executive


@pytest.fixture
def begun(monkeypatch):
    """Return what lets `run` begin no mission, and tells its description and its options."""
    loaded, made = [], []

    def load_mission(mission, settings, **more):
        loaded.append((mission, list(settings), more))
        return f"{mission} as given"

    monkeypatch.setattr(load, "load_mission", load_mission)
    monkeypatch.setattr(selections, "model_of", lambda description: "m545")
    preset = SimpleNamespace(answer=True, choices=("left",))
    monkeypatch.setattr(preset_answers, "preset_answers", lambda words, description: preset)
    monkeypatch.setattr(running, "Run", lambda *given: made.append(given) or "the run")
    monkeypatch.setattr(run, "startable", nullcontext)

    def carried_out(given, watched, **told):
        made.append((given, watched, told))
        return 0

    monkeypatch.setattr(run, "carried_out", carried_out)

    def begin(*words):
        loaded.clear()
        made.clear()
        assert executive(monkeypatch, "run", "yard", *words) == 0
        (description, options), (_, watched, told) = made
        assert description == "yard as given"
        return SimpleNamespace(loaded=list(loaded), options=options, watched=watched, told=told)

    return begin


@pytest.mark.parametrize("log", ["drive.bag", "nowhere/drive.mcap"])
def test_a_log_that_cannot_be_recorded_is_refused_before_the_run_has_a_folder(
    log, monkeypatch, capsys, tmp_path
):
    monkeypatch.chdir(tmp_path)
    words = ("run", "map_site", "--run-dir", "r", "--record-log", log)
    assert executive(monkeypatch, *words) == 2
    told = f"error: --record-log: {log}: name a .mcap file in a folder that exists\n"
    assert (capsys.readouterr().err, list(tmp_path.iterdir())) == (told, [])


def test_without_options_the_mission_runs_as_it_is(begun):
    found = begun()
    assert found.loaded == [("yard", [], {"is_for_here": True})]
    options = found.options
    assert (options.seed, options.run_dir, options.real_time, options.apart) == (
        1,
        None,
        False,
        False,
    )
    assert (options.answer, options.choices) == (True, ("left",))
    assert (options.groot, options.live) == (None, None)
    assert found.told == {"quiet": False, "as_json": False}


def test_a_folder_of_stones_is_a_setting_of_the_site(begun, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stones").mkdir()
    ((_, settings, _),) = begun("--stones", "stones").loaded
    assert settings == [f'robot.site.stones.folder="{tmp_path}/stones"']


def test_a_wall_is_laid_over_the_mission_before_what_is_set(begun, monkeypatch, capsys):
    wall = Path("wall.yaml")
    monkeypatch.setattr(
        wall_of_mission, "wall_of_mission", lambda path: (["structure=wall"], ["noise", "most"])
    )
    ((_, settings, _),) = begun("--wall", wall, "--set", "robot.plugin=kinematic").loaded
    assert settings == ["structure=wall", "robot.plugin=kinematic"]
    told = "wall.yaml: noise, most: for `executive place` alone; not used here\n"
    assert capsys.readouterr().err == told
    monkeypatch.setattr(wall_of_mission, "wall_of_mission", lambda path: ([], []))
    begun("--wall", wall)
    assert capsys.readouterr().err == ""


def test_a_machine_behind_the_wire_is_that_of_the_mission_and_runs_in_real_time(begun):
    found = begun("--machine", "unix:/run/m", "--set", "robot.model=mine")
    assert [one[1:] for one in found.loaded] == [
        ([], {}),
        (
            ["robot.plugin=wire", 'robot.model="m545"', "robot.address=unix:/run/m",
             "robot.model=mine"],
            {"is_for_here": True},
        ),
    ]  # fmt: skip
    assert (found.options.real_time, found.options.apart) == (True, False)


def test_options_reach_the_run(begun, tmp_path):
    found = begun(
        *("--seed", 7, "--run-dir", tmp_path / "r", "--real-time", "--record", "--attended"),
        *("--pause-on-failure", "--runner", "thread", "--groot-port", 2000, "--live"),
        *("--quiet", "--json"),
    )
    options = found.options
    assert (options.seed, options.run_dir, options.record) == (7, tmp_path / "r", True)
    assert (options.real_time, options.apart, options.runner) == (True, True, "thread")
    assert (options.attended, options.pause_on_failure) == (True, True)
    assert (options.groot, options.live) == (2000, 9876)
    assert found.told == {"quiet": True, "as_json": True}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--dry", "--record"), "--record: a dry run has no machine; leave it out"),
        (("--dry", "--groot-port", 2000), "--groot-port: a dry run has no machine; leave it out"),
        (("--runs", 3), "--runs: it belongs to --dry; leave it out"),
        (("--at-least", 50), "--at-least: it belongs to --dry; leave it out"),
        (("--by-tree",), "--by-tree: it belongs to --dry; leave it out"),
        (("--runner", "thred"), "--runner: 'thred' is unknown. Did you mean 'thread'?"),
    ],
)
def test_options_that_do_not_go_together_are_refused(monkeypatch, capsys, words, told):
    assert executive(monkeypatch, "run", "yard", *words) == 2
    assert capsys.readouterr().err == f"error: {told}\n"


def test_a_run_that_was_cut_off_is_taken_up_again(monkeypatch, tmp_path):
    asked = []
    monkeypatch.setattr(resume, "startable", nullcontext)
    monkeypatch.setattr(
        resuming, "resumed_run", lambda folder, **ports: asked.append((folder, ports)) or "again"
    )

    def carried_out(made, watched, **told):
        asked.append((made, watched.groot, watched.live, told))
        return 3

    monkeypatch.setattr(resume, "carried_out", carried_out)
    assert executive(monkeypatch, "resume", tmp_path, "--groot", "--quiet") == 3
    assert asked == [
        (tmp_path, {"groot": 1667, "live": None}),
        ("again", 1667, None, {"quiet": True, "as_json": False}),
    ]


def test_the_settings_of_a_machine_are_quoted_where_they_need_it():
    (_, model, _) = run._wire_to("host:1", "folder of mine")
    assert json.loads(model.partition("=")[2]) == "folder of mine"
