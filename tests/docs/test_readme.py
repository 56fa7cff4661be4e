"""The README is short and true: its mission has no mistake, its error output is what is printed."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```(\w*)\n(.*?)```", TEXT, re.S)
MISSION = next(body for language, body in BLOCKS if language == "yaml")


def executive(words, cwd):
    code = (
        f"import sys; sys.argv = ['executive', *{words!r}]; from executive.commands.main "
        "import main; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=cwd, timeout=120
    )


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "yard.yaml").write_text(MISSION)
    return tmp_path


def test_is_at_most_150_lines():
    assert len(TEXT.splitlines()) <= 150


def test_the_folders_of_its_map_exist():
    rows = re.findall(r"^ {4,6}((?:[a-z_]+/ )+) *\w", TEXT, re.M)
    names = [name for row in rows for name in re.findall(r"[a-z_]+", row)]
    assert len(names) >= 15
    known = {path.stem for path in [*ROOT.iterdir(), *(ROOT / "executive").iterdir()]}
    assert [name for name in names if name not in known] == []


def test_its_mission_has_no_mistake(folder):
    assert executive(["check", "yard.yaml"], folder).returncode == 0


def test_its_error_output_is_what_is_printed(folder):
    wrong = MISSION.replace("SelectLargest", "SelectLargst").replace("300 deg", "300 parsec")
    (folder / "yard.yaml").write_text(wrong)
    shown = next(body for language, body in BLOCKS if not language and "$ executive check" in body)
    assert executive(["check", "yard.yaml"], folder).stderr.splitlines() == shown.splitlines()[1:]
