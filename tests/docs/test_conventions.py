"""The page of conventions is true: its commands run and end as it says, its names are those of the
code.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from executive.machine.machine import load_machine

PAGE = (Path(__file__).parents[2] / "docs" / "conventions.md").read_text(encoding="utf-8")
COMMANDS = re.search(r"```sh\n(.*?)```", PAGE, re.S).group(1).strip().splitlines()


@pytest.mark.parametrize("line", COMMANDS)
def test_a_command_ends_with_the_status_that_the_page_says(line: str, tmp_path: Path) -> None:
    command, _, comment = line.partition("#")
    status = int(re.search(r"\d+", comment).group()) if comment else 0
    executive = Path(sys.executable).with_name("executive")
    done = subprocess.run(
        [executive, *command.split()[1:]],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == status, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout + done.stderr


def test_frames_of_the_page_are_frames_of_the_machine() -> None:
    machine = load_machine("m545")
    assert (machine.base_link, machine.cabin_link, machine.gripper_link) == (
        "base",
        "cabin",
        "gripper",
    )
    assert {"base", "cabin", "gripper"} <= set(re.findall(r"^\| `(\w+)` \|", PAGE, re.M))


def test_the_page_is_one_page() -> None:
    assert len(PAGE.splitlines()) <= 100
