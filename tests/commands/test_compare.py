"""`executive compare`: what differs between two runs, and between two campaigns."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive.commands.main import app
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = Path(__file__).with_name("waits.yaml").read_text(encoding="utf-8")


def run(folder: Path, mission: str = MISSION, seed: int = 1) -> Path:
    path = folder.with_suffix(".yaml")
    path.write_text(mission, encoding="utf-8")
    Run(load_mission(str(path)), Options(seed=seed, run_dir=folder)).execute(lambda _: None)
    return folder


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("runs")
    return {
        "one": run(folder / "one"),
        "same": run(folder / "same"),
        "longer": run(folder / "longer", MISSION.replace("0.3 s", "0.5 s")),
    }


def compared(*words: object) -> dict[str, object]:
    done = CliRunner().invoke(app, ["compare", *map(str, words), "--json"])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def test_equal_runs_have_equal_journals(runs: dict[str, Path]) -> None:
    found = compared(runs["one"], runs["same"])
    assert found["settings"] == {}
    assert found["first_difference"] is None


def test_a_changed_setting_is_named_and_its_first_effect(runs: dict[str, Path]) -> None:
    found = compared(runs["one"], runs["longer"])
    (path,) = found["settings"]
    assert path.startswith("trees.main")
    assert found["settings"][path] == [0.3, 0.5]
    one, other = found["first_difference"]["entries"]
    assert one["kind"] == "node_ended"
    assert other["time_s"] > one["time_s"]
    text = CliRunner().invoke(app, ["compare", str(runs["one"]), str(runs["longer"])]).output
    assert "settings: 1 difference" in text
    assert "journals: the first difference is entry" in text
    assert "missions that succeed" in text


def test_a_journal_that_ends_before_is_told(runs: dict[str, Path], tmp_path: Path) -> None:
    short = tmp_path / "short"
    shutil.copytree(runs["one"], short)
    lines = (short / "journal.jsonl").read_text().splitlines(keepends=True)
    (short / "journal.jsonl").write_text("".join(lines[:5]))
    found = compared(runs["one"], short)
    assert found["first_difference"]["entry"] == 5
    assert found["first_difference"]["entries"][1] is None


def test_what_can_be_read_of_a_damaged_journal_is_compared(
    runs: dict[str, Path], tmp_path: Path
) -> None:
    damaged = tmp_path / "damaged"
    shutil.copytree(runs["one"], damaged)
    lines = (damaged / "journal.jsonl").read_text().splitlines(keepends=True)
    lines[4] = lines[4].replace("0", "1", 1)
    (damaged / "journal.jsonl").write_text("".join(lines))
    found = compared(runs["one"], damaged)
    assert found["damages"][0] == []
    (told,) = found["damages"][1]
    assert "journal.jsonl:5:" in told
    assert "the 4 lines before it are read" in told


def test_a_folder_that_is_no_run_is_refused(runs: dict[str, Path], tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["compare", str(runs["one"]), str(tmp_path)])
    assert "holds neither report.json nor journal.jsonl" in str(done.exception)
