"""The page on estimation is true: its selections load, its commands have the options that it gives
them.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
import yaml

from executive import registry

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "estimation.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.S)
LINES = [line for language, body in BLOCKS if language == "sh" for line in body.splitlines()]
COMMANDS = [line.split("#")[0].strip() for line in LINES if line.startswith("executive ")]
BENCHMARKS = [line.split("#")[0].strip() for line in LINES if line.startswith("python ")]


def usage(words: list[str]) -> str:
    with tempfile.TemporaryDirectory() as home:  # matplotlib leaves its list of fonts there
        environment = {"COLUMNS": "200", "PATH": "", "HOME": home}
        ended = subprocess.run(
            [sys.executable, *words, "--help"],
            capture_output=True,
            text=True,
            timeout=120,
            env=environment,
        )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def test_its_selections_are_plugins() -> None:
    (body,) = (body for language, body in BLOCKS if language == "yaml")
    for capability, name in yaml.safe_load(body).items():
        assert name in {plugin.name for plugin in registry.installed(capability)}


@pytest.mark.parametrize("capability", ["estimation", "odometry"])
def test_it_shows_every_plugin(capability: str) -> None:
    for plugin in registry.installed(capability):
        assert f"| `{plugin.name}` |" in PAGE


@pytest.mark.parametrize("verb", sorted({command.split()[1] for command in COMMANDS}))
def test_its_commands_know_their_options(verb: str) -> None:
    code = "import sys; sys.argv[0] = 'executive'; from executive.commands.main import main; main()"
    known = set(re.findall(r"--[\w-]+", usage(["-c", code, verb])))
    for command in COMMANDS:
        if command.split()[1] == verb:
            assert set(re.findall(r"--[\w-]+", command)) <= known


@pytest.mark.parametrize("command", BENCHMARKS)
def test_its_benchmarks_exist_and_know_their_options(command: str) -> None:
    script = ROOT / command.split()[1]
    assert set(re.findall(r"--[\w-]+", command)) <= set(
        re.findall(r"--[\w-]+", usage([str(script)]))
    )


def test_its_pictures_exist() -> None:
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", PAGE)
    assert len(pictures) == 2
    for picture in pictures:
        assert (ROOT / "docs" / picture).read_bytes().startswith(b"\x89PNG")


def test_there_is_something_to_check() -> None:
    assert len(COMMANDS) >= 5
    assert len(BENCHMARKS) >= 4
