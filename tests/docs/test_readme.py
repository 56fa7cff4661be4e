"""The README is short and true: its mission is checked, its commands work, its error output is what
is printed.
"""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```(\w*)\n(.*?)```", TEXT, re.S)
MISSION = next(body for language, body in BLOCKS if language == "yaml")
COMMANDS = [
    shlex.split(line, comments=True)
    for language, body in BLOCKS
    if language == "sh"
    for line in body.splitlines()
    if line.startswith("executive ")
]


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
    (tmp_path / "my_tree.yaml").write_text(MISSION)
    return tmp_path


def test_is_at_most_150_lines():
    assert len(TEXT.splitlines()) <= 150


def test_its_pictures_and_pages_exist():
    targets = re.findall(r"\]\((docs/[^)#]+)\)", TEXT)
    assert targets
    assert [t for t in targets if not (ROOT / t).exists()] == []


def test_the_folders_of_its_map_exist():
    names = re.findall(r"^ {4,6}([a-z_]+)(?:/|\.py) ", TEXT, re.M)
    assert len(names) >= 10
    known = {path.stem for path in [*ROOT.iterdir(), *(ROOT / "executive").iterdir()]}
    assert [name for name in names if name not in known] == []


def test_its_mission_has_no_mistake(folder):
    assert executive(["check", "yard.yaml"], folder).returncode == 0


def test_its_error_output_is_what_is_printed(folder):
    wrong = MISSION.replace("SelectLargest", "SelectLargst").replace("120 deg", "120 parsec")
    (folder / "yard.yaml").write_text(wrong)
    shown = next(body for language, body in BLOCKS if not language and "$ executive check" in body)
    assert executive(["check", "yard.yaml"], folder).stderr.splitlines() == shown.splitlines()[1:]


@pytest.mark.parametrize("words", [c for c in COMMANDS if c[1] != "run"], ids=" ".join)
def test_its_light_commands_work(words, folder):
    words = words[: words.index(">")] if ">" in words else words
    ended = executive(words[1:], folder)
    assert ended.returncode == 0, ended.stderr


@pytest.mark.parametrize("words", [c for c in COMMANDS if c[1] == "run"], ids=" ".join)
def test_the_missions_it_runs_are_accepted(words, folder):
    """The options of `run` that choose the mission, handed to `check`: whole missions run
    elsewhere.
    """
    sets = [word for i, word in enumerate(words) if words[i - 1] == "--set" or word == "--set"]
    assert executive(["check", words[2], *sets], folder).returncode == 0
