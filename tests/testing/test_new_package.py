"""A package of `plugins new` passes the kit, for each capability, as soon as it is installed."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import pytest

from executive import registry
from executive.errors import ConfigError
from executive.testing.new_package import new_package
from executive.testing.run import Trial, hold_to_contract

TEMPLATES = [
    one.name.removesuffix(".py.txt") for one in (files("executive.testing") / "templates").iterdir()
]
MISSION = Path(__file__).with_name("try_it.yaml").read_text(encoding="utf-8")

Install = Callable[..., Path]


def put_on_the_path(install: Install, capability: str, folder: Path) -> str:
    """Write a new package, install its module, and return the name that it announces."""
    name = f"fresh_{capability}"
    module, project, *_ = new_package(capability, name, folder)
    group, announced, target = re.search(
        r'"executive\.(\w+)\.v1"\]\n(\w+) = "(.*)"', project.read_text()
    ).groups()
    install(name, {module.name: module.read_text()}, {group: {announced: target}})
    return announced


def test_there_is_a_template_for_each_capability() -> None:
    assert sorted(TEMPLATES) == sorted([*registry.capabilities(), registry.SMOOTHERS, "leaf"])


@pytest.mark.parametrize("capability", sorted(TEMPLATES))
def test_a_new_package_passes_the_kit(install: Install, capability: str, tmp_path: Path) -> None:
    name = put_on_the_path(install, capability, tmp_path)
    findings = hold_to_contract(Trial(capability, name))
    assert [one.line() for one in findings if one.outcome == "fail"] == []
    assert sum(one.outcome == "pass" for one in findings) >= 7


@pytest.mark.slow
def test_what_was_made_runs_in_a_mission_of_its_own_process(
    install: Install, tmp_path: Path
) -> None:
    for capability in ("segmentation", "leaf"):
        put_on_the_path(install, capability, tmp_path)
    (tmp_path / "try_it.yaml").write_text(MISSION)
    paths = [str(tmp_path / "site"), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [Path(sys.executable).with_name("executive"), "run", "try_it.yaml", "--json"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["outcome"] == "success"
    assert report["ended_s"] - report["started_s"] >= 2.0


def test_a_folder_that_exists_and_a_name_that_is_none_are_refused(tmp_path: Path) -> None:
    new_package("segmentation", "mine", tmp_path)
    with pytest.raises(ConfigError, match="exists already"):
        new_package("segmentation", "mine", tmp_path)
    with pytest.raises(ConfigError, match="is no name"):
        new_package("segmentation", "My-Plugin", tmp_path)
    with pytest.raises(ConfigError, match="Did you mean 'segmentation'"):
        new_package("segmentaton", "other", tmp_path)


@pytest.mark.parametrize("name", ["class", "json", "numpy", "executive"])
def test_a_name_that_python_knows_already_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=f"'{name}' is taken: .*choose another name"):
        new_package("segmentation", name, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_foreign_package_of_that_name_is_told_with_its_place_and_not_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    foreign = tmp_path / "path" / "plugins" / "__init__.py"
    foreign.parent.mkdir(parents=True)
    foreign.write_text("raise RuntimeError('imported')\n")
    monkeypatch.syspath_prepend(str(tmp_path / "path"))
    with pytest.raises(ConfigError, match=re.escape(str(foreign))):
        new_package("segmentation", "plugins", tmp_path)
    assert "plugins" not in sys.modules
