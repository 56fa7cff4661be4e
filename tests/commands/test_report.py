"""`executive report` on the folder of a run: whole, damaged, unfinished, or none at all."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.commands.main import app
from executive.errors import ConfigError
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = Path(__file__).with_name("waits.yaml").read_text(encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "waits.yaml"
    path.write_text(MISSION, encoding="utf-8")
    Run(load_mission(str(path)), Options(seed=3, run_dir=tmp_path / "run")).execute(lambda _: None)
    return tmp_path / "run"


def page_of(folder: Path) -> str:
    done = CliRunner().invoke(app, ["report", str(folder)])
    assert done.exit_code == 0, done.output
    page = (folder / "report.html").read_text(encoding="utf-8")
    return page.split("<main>")[1].split("</main>")[0]


def test_the_page_of_a_run_has_its_outcome_its_course_and_its_command(folder: Path) -> None:
    page = page_of(folder)
    assert "waits, seed 3" in page
    assert '<span class="good">success</span>' in page
    assert f"executive run {folder}/mission.yaml --seed 3" in page
    (chart,) = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page)
    bars = json.loads(chart)["data"]["values"]
    assert [(bar["name"], bar["result"]) for bar in bars] == [("wait", "success")] * 2
    assert bars[1]["to"] - bars[1]["from"] == pytest.approx(0.3, abs=0.051)  # a tick is 0.05 s


def test_the_command_on_the_page_runs_the_same_mission(folder: Path) -> None:
    (command,) = re.findall(r"<code>(executive run .*?)</code>", page_of(folder))
    again = folder.parent / "again"
    done = CliRunner().invoke(app, [*command.split()[1:], "--run-dir", str(again), "--quiet"])
    assert done.exit_code == 0, done.output
    assert (again / "journal.jsonl").read_bytes() == (folder / "journal.jsonl").read_bytes()


def test_a_run_that_was_killed_is_reported_as_far_as_it_went(folder: Path) -> None:
    (folder / "report.json").unlink()
    with (folder / "journal.jsonl").open("a", encoding="utf-8") as file:
        file.write('{"sequence": 99, "tick"')
    page = page_of(folder)
    assert "there is no report: the run goes on, or was killed" in page
    assert "its last line was cut off after 23 bytes" in page
    assert page.count("data-chart") == 1  # what was read of the journal is drawn


def test_json_needs_no_page(folder: Path) -> None:
    done = CliRunner().invoke(app, ["report", str(folder), "--json"])
    found = json.loads(done.stdout)
    assert found["report"]["outcome"] == "success"
    assert found["measurements"]["success"] == {"hits": 1, "of": 1}
    assert found["damages"] == []
    assert not (folder / "report.html").exists()


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    for path, told in ((tmp_path, "neither report.json nor"), (tmp_path / "x", "is no folder")):
        done = CliRunner().invoke(app, ["report", str(path)])
        assert isinstance(done.exception, ConfigError)
        assert told in str(done.exception)
