"""A fingerprint tells installations apart by what decides a result, and says how they differ."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from executive.campaign.execution.fingerprint import PACKAGES, differences, local_fingerprint

TAKE = """
from executive.campaign.execution.fingerprint import local_fingerprint
print(local_fingerprint().sources)
"""


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Return a folder with the source files of a small installation."""
    for package in PACKAGES:
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").write_text("")
    parts = ("campaign/execution/fingerprint.py", "campaign/__init__.py")
    home = Path(sys.modules["executive"].__file__ or "").parent
    for part in (*parts, "campaign/execution/__init__.py"):
        (tmp_path / "executive" / part).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "executive" / part).write_text((home / part).read_text())
    return tmp_path


def sources(copy: Path) -> str:
    env = {**os.environ, "PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "-P", "-c", TAKE], env=env, cwd="/", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_changed_line_is_seen_and_a_stray_file_is_not(copy: Path) -> None:
    before = sources(copy)
    (copy / "executive" / "notes.md").write_text("an editor's file")
    assert sources(copy) == before
    (copy / "executive_plugins" / "new.py").write_text("GAIN = 2\n")
    assert sources(copy) != before


def test_the_package_and_what_decides_results_are_in_it() -> None:
    taken = local_fingerprint()
    assert {"numpy", "gtsam", "mujoco"} <= set(taken.distributions)
    assert not {"pytest", "ruff", "distributed"} & set(taken.distributions)
    assert len(taken.sources) == 64


def test_what_differs_is_said_in_words() -> None:
    here = local_fingerprint()
    assert differences(here, here) == ()
    there = replace(
        here,
        version="0.0.1",
        python="3.9",
        sources="f" * 64,
        distributions={**here.distributions, "numpy": "1.0"},
    )
    said = "; ".join(differences(here, there))
    assert f"version of executive 0.0.1 instead of {here.version}" in said
    assert "Python 3.9 instead of 3." in said
    assert "source files of executive" in said
    assert f"version of numpy 1.0 instead of {here.distributions['numpy']}" in said


def test_a_package_that_only_one_has_is_no_difference() -> None:
    here = local_fingerprint()
    there = {name: version for name, version in here.distributions.items() if name != "torch"}
    assert differences(here, replace(here, distributions={**there, "other": "1.0"})) == ()
