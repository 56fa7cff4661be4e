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


@pytest.mark.parametrize(
    "words", [["--help"], ["check", "pick_and_place"], ["check", "relocate"], ["run", "--help"]]
)
def test_reading_imports_no_algorithm(words: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _SCRIPT, json.dumps(words)],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert json.loads(done.stdout.splitlines()[-1]) == []
