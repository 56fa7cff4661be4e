"""The page on benchmarks is true: it lists every one, and its commands know their options."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
BENCHMARKS = {
    path.name: path
    for path in sorted((ROOT / "tests" / "benchmarks").glob("*.py"))
    if "def main(" in path.read_text(encoding="utf-8")
}
COMMANDS = re.findall(r"python (tests/benchmarks/.*?)(?:  +#.*)?$", PAGE, re.M)

# Run the `--help` of all of them in one process, and tell what they print, and what they import.
HELP = """
import contextlib, io, json, runpy, sys
texts = {}
for script in sys.argv[1:]:
    sys.path[0] = script.rpartition("/")[0]
    sys.argv = [script, "--help"]
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            runpy.run_path(script, run_name="__main__")
        except SystemExit as end:
            assert end.code == 0, script
    texts[script.rpartition("/")[2]] = out.getvalue()
heavy = sorted({"numpy", "executive", "open3d", "torch"} & set(sys.modules))
print(json.dumps({"texts": texts, "heavy": heavy}))
"""


@pytest.fixture(scope="module")
def answer() -> dict:
    words = [sys.executable, "-c", HELP, *map(str, BENCHMARKS.values())]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_every_benchmark_tells_its_usage_and_its_exit_status(answer: dict) -> None:
    assert len(answer["texts"]) == len(BENCHMARKS) >= 21
    for name, text in answer["texts"].items():
        assert f"python tests/benchmarks/{name}" in text, name
        assert "Exit status: 0 if every bound holds, 1 if one is missed" in text, name


def test_help_needs_no_heavy_import(answer: dict) -> None:
    assert answer["heavy"] == []


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_page_lists_every_benchmark_with_its_command(name: str) -> None:
    assert re.search(rf"^\| `{name}` \| .+ \| .+ \| .+ \|$", PAGE, re.M)
    assert any(command.split()[0] == f"tests/benchmarks/{name}" for command in COMMANDS)


def test_the_commands_of_the_page_know_their_options(answer: dict) -> None:
    for command in COMMANDS:
        text = answer["texts"][Path(command.split()[0]).name]
        assert set(re.findall(r"--[\w-]+", command)) <= set(re.findall(r"--[\w-]+", text))


def test_every_benchmark_that_a_page_names_is_there() -> None:
    for page in (ROOT / "docs").glob("*.md"):
        for path in re.findall(r"tests/[\w/]+\.py", page.read_text(encoding="utf-8")):
            assert (ROOT / path).is_file(), f"{page.name}: {path}"
