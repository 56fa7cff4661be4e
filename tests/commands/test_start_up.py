"""What is read is read without algorithms: `check` and `--help` import no heavy package."""

import json
import subprocess
import sys

import pytest

HEAVY = ("open3d", "rerun", "mujoco", "torch", "gtsam", "scipy", "numba", "pinocchio", "py_trees")
_SCRIPT = """
import json, sys
from executive.commands.main import main
sys.argv = ["executive", *json.loads(sys.argv[1])]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print(json.dumps([name for name in json.loads(sys.argv_heavy) if name in sys.modules]))
""".replace("sys.argv_heavy", repr(json.dumps(HEAVY)))


def imported_by(words: list[str]) -> list[str]:
    """Return the heavy packages that a command imports in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT, json.dumps(words)],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    found: list[str] = json.loads(done.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize(
    "words", [["--help"], ["check", "pick_and_place"], ["check", "relocate"], ["run", "--help"]]
)
def test_reading_imports_no_algorithm(words: list[str]) -> None:
    assert imported_by(words) == []


def test_a_dry_run_imports_the_nodes_and_no_algorithm() -> None:
    assert imported_by(["run", "map_site", "--dry", "--runs", "2"]) == ["py_trees"]
