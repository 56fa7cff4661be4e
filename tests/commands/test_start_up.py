"""What is read is read without algorithms: `check`, `plugins list` and `--help` import none."""

import json
import subprocess
import sys

HEAVY = (
    *("open3d", "rerun", "mujoco", "torch", "gtsam", "scipy", "numba", "pinocchio", "py_trees"),
    *("ruckig", "fcl", "mcap", "matplotlib"),
)
_SCRIPT = """
import json, sys
from executive.commands.main import main
found = {}
for words in json.loads(sys.argv[1]):
    sys.argv = ["executive", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, end.code
    found[" ".join(words)] = [name for name in json.loads(sys.argv_heavy) if name in sys.modules]
print(json.dumps(found))
""".replace("sys.argv_heavy", repr(json.dumps(HEAVY)))


def imported_by(*commands: list[str]) -> dict[str, list[str]]:
    """Return the heavy packages that a process of its own holds after each of the commands."""
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT, json.dumps(commands)],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    found: dict[str, list[str]] = json.loads(done.stdout.splitlines()[-1])
    return found


def test_reading_imports_no_algorithm() -> None:
    commands = (
        ["--help"],
        ["run", "--help"],
        ["estimate", "--help"],
        ["plugins", "list"],
        ["plugins", "list", "--json"],
        ["check", "pick_and_place"],
        ["check", "relocate"],
    )
    assert imported_by(*commands) == {" ".join(words): [] for words in commands}


def test_a_dry_run_imports_the_nodes_and_no_algorithm() -> None:
    words = ["run", "map_site", "--dry", "--runs", "2"]
    assert imported_by(words) == {" ".join(words): ["py_trees"]}
