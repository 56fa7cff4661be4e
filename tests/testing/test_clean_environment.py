"""A package of `plugins new`, installed beside the wheel in a fresh environment, works there."""

import json
import os
import shutil
import site
import subprocess
import sys
import venv
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
MISSION = Path(__file__).with_name("try_it.yaml").read_text(encoding="utf-8")


class Environment:
    """A virtual environment that has the wheel's own files, and libraries from this environment."""

    def __init__(self, folder: Path) -> None:
        venv.create(folder, with_pip=True)
        self.bin = folder / "bin"
        self.home = folder.parent
        packages = next(folder.glob("lib/*/site-packages"))
        for old in packages.glob("setuptools*"):  # Python 3.11 brings one that is too old
            shutil.rmtree(old)
        # Libraries are taken from here, since nothing may be downloaded; what the environment
        # itself holds comes first on its path.
        (packages / "libraries.pth").write_text(
            "".join(f"import site; site.addsitedir({one!r})\n" for one in site.getsitepackages())
        )

    def run(self, *words: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        return subprocess.run(
            [self.bin / str(words[0]), *map(str, words[1:])],
            env=kept,
            cwd=cwd or self.home,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    def install(self, source: Path) -> None:
        offline = ("--no-deps", "--no-index", "--no-build-isolation", "--quiet")
        done = self.run("python", "-m", "pip", "install", *offline, "--force-reinstall", source)
        assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Environment:
    """A fresh environment with the product installed from a copy of the repository's files."""
    folder = tmp_path_factory.mktemp("clean")
    skipped = (".git", ".venv", "build", "dist", "runs", "tests", "docs", "*.egg-info", ".*_cache")
    shutil.copytree(ROOT, folder / "source", ignore=shutil.ignore_patterns(*skipped))
    made = Environment(folder / "environment")
    made.install(folder / "source")
    return made


def test_the_product_is_imported_from_the_fresh_environment(environment: Environment) -> None:
    code = "import executive, executive_plugins; print(executive.__file__)"
    found = environment.run("python", "-c", code).stdout.strip()
    assert Path(found).is_relative_to(environment.bin.parent)


def test_a_new_package_passes_the_kit_and_runs_in_a_mission(environment: Environment) -> None:
    for capability in ("segmentation", "leaf"):
        name = f"fresh_{capability}"
        made = environment.run("executive", "plugins", "new", capability, name)
        assert made.returncode == 0, made.stderr
        environment.install(environment.home / name)
    kit = environment.run("executive", "plugins", "test", "segmentation", "fresh_segmentation")
    assert kit.returncode == 0, kit.stdout + kit.stderr
    (environment.home / "try_it.yaml").write_text(MISSION)
    done = environment.run("executive", "run", "try_it.yaml", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["outcome"] == "success"
    assert sys.prefix not in done.stderr
