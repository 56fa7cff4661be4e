"""`executive run --dry` and `executive coverage`, through the front door."""

import json
import sys

import pytest

from executive.commands.main import main
from executive.errors import ConfigError
from executive.mission.run_folder import RunFolder
from executive.tree.sources import shipped_names


@pytest.fixture
def executive(monkeypatch, capsys):
    def run(*given):
        monkeypatch.setattr(sys, "argv", ["executive", *map(str, given)])
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0), *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


@pytest.mark.parametrize("mission", shipped_names())
def test_every_shipped_mission_runs_dry_and_its_nodes_are_told(executive, mission):
    status, output, errors = executive("run", mission, "--dry", "--json")
    answer = json.loads(output)
    (run,) = answer["runs"]
    assert status == (0 if run["outcome"] == "success" else 1)
    assert run["ended_s"] > 0
    assert "0:Localise" in errors
    assert answer["coverage"]["taken"] >= 5


MOCKS = """api: 1
mocks:
  Localise: {status: running}
expect:
  outcome: failure
  ends: {Localise: halted}
  not_visited: [SurveySite]
"""


def test_expectations_decide_the_exit_status(executive, tmp_path):
    file = tmp_path / "lost.yaml"
    file.write_text(MOCKS)
    assert executive("run", "map_site", "--dry", "--mocks", file)[0] == 0
    file.write_text(MOCKS.replace("outcome: failure", "outcome: success"))
    status, _, errors = executive("run", "map_site", "--dry", "--mocks", file)
    assert status == 1
    assert "lost.yaml:5:12: expected success, and it ended in failure: not done within" in errors
    file.write_text(MOCKS.replace("Localise:", "Localyse:"))
    status, _, errors = executive("run", "map_site", "--dry", "--mocks", file)
    assert status == 2
    assert "lost.yaml:3:3: error: the mission has no leaf" in errors


def test_coverage_counts_the_runs_of_folders_and_fails_below_a_share(executive, tmp_path):
    folder = tmp_path / "runs"
    run = ("run", "map_site", "--dry", "--run-dir", folder, "--runs", 4, "--json")
    status, output, _ = executive(*run)
    assert status == 0
    together = json.loads(output)["coverage"]
    folders = sorted(folder.iterdir())
    status, output, _ = executive("coverage", *folders, "--json")
    found = json.loads(output)
    assert status == 0
    assert [one["dry"] for one in found["runs"]] == [True] * 4
    assert (found["nodes"], found["never"]) == (together["nodes"], together["never"])
    status, output, errors = executive("coverage", folders[0], "--at-least", 99)
    assert status == 1
    assert "never taken:" in output
    assert "of the branches were taken, not 99 %" in errors


def test_runs_of_different_trees_are_refused(executive, tmp_path):
    for name in ("map_site", "inspect"):
        executive("run", name, "--dry", "--run-dir", tmp_path / name)
    status, _, errors = executive("coverage", tmp_path / "map_site", tmp_path / "inspect")
    assert status == 2
    assert "runs of different trees" in errors
    assert executive("coverage", tmp_path)[0] == 2
    with pytest.raises(ConfigError, match="is a dry run, which cannot be resumed"):
        RunFolder.open(tmp_path / "map_site")


@pytest.mark.parametrize("options", [("--dry", "--real-time"), ("--runs", "3"), ("--mocks", "m")])
def test_options_of_the_other_kind_of_run_are_refused(executive, options):
    status, _, errors = executive("run", "map_site", *options)
    assert status == 2
    assert "leave it out" in errors


def test_a_dry_run_has_no_report_and_the_cure_is_told(executive, tmp_path):
    folder = tmp_path / "dry"
    executive("run", "map_site", "--dry", "--run-dir", folder)
    status, _, errors = executive("report", folder)
    assert status == 2
    assert f"{folder} holds a dry run: its leaves were mocked" in errors
    assert f"`executive coverage {folder}`" in errors
    assert not list(folder.glob("report*"))
