"""An installed wheel claims four names, and a source distribution can be built and tested."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
NAMES = {"executive", "executive_plugins", "executive_robot_models", "executive_trees"}
FOREIGN = ("plugins", "trees", "robot_models")


def build(kind: str, source: Path, out: Path) -> Path:
    """Build with the setuptools that is there: nothing is downloaded."""
    code = f"from setuptools import build_meta; print(build_meta.build_{kind}({str(out)!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=source, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return out / done.stdout.split()[-1]


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository's files, so that a build leaves nothing behind."""
    copy = tmp_path_factory.mktemp("source") / "executive"
    skipped = (
        ".git",
        ".venv",
        "build",
        "dist",
        "runs",
        "shared",
        "__pycache__",
        "*.egg-info",
        ".*_cache",
    )
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*skipped))
    return copy


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", source, tmp_path_factory.mktemp("wheel"))


def test_a_wheel_claims_only_its_own_names(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as packed:
        tops = {name.split("/")[0] for name in packed.namelist()}
    assert {name for name in tops if not name.endswith(".dist-info")} == NAMES


def test_a_wheel_holds_the_data_of_its_packages(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as packed:
        names = set(packed.namelist())
    for folder, name in (("trees", "executive_trees"), ("robot_models", "executive_robot_models")):
        wanted = {f"{name}/{p.relative_to(ROOT / folder)}" for p in (ROOT / folder).rglob("*.yaml")}
        assert wanted
        assert wanted <= names
    weights = {
        f"executive_plugins/grasping/weights/m545_{n}.safetensors"
        for n in ("two_stream", "two_stream_kind", "four_layer")
    }
    assert {"executive/py.typed", "executive_plugins/py.typed", *weights} <= names


def test_foreign_packages_of_the_folders_names_are_in_nobodys_way(
    wheel: Path, tmp_path: Path
) -> None:
    site, foreign = tmp_path / "site", tmp_path / "foreign"
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(site)
    for name in FOREIGN:
        (foreign / name).mkdir(parents=True)
        (foreign / name / "__init__.py").write_text("raise RuntimeError('foreign')\n")
    code = "import sys; sys.argv[0] = 'executive'; from executive.commands.main import main; main()"
    path = os.pathsep.join([str(foreign), str(site)])
    done = subprocess.run(
        [sys.executable, "-c", code, "check", "pick_and_place"],
        env={**os.environ, "PYTHONPATH": path},
        cwd=foreign,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "pick_and_place: no mistake found" in done.stderr


def test_a_source_distribution_holds_what_a_build_and_a_test_run_need(
    source: Path, tmp_path: Path
) -> None:
    with tarfile.open(build("sdist", source, tmp_path)) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    for folder in ("executive", "plugins", "trees", "robot_models", "tests", "docs"):
        wanted = {
            str(path.relative_to(source))
            for path in (source / folder).rglob("*")
            if path.is_file() and "__pycache__" not in path.parts
        }
        assert wanted <= names, sorted(wanted - names)[:5]
    assert {"Makefile", "pyproject.toml", "setup.py", "CONTRIBUTING.md", "CITATION.cff"} <= names
