"""A copy of the tree in which faults are planted and tests are run, apart from the original."""

import compileall
import json
import os
import py_compile
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

PARTS = ("executive", "plugins", "robot_models", "trees", "tests", "docs", "build/typing")
CODE = ("executive", "plugins")
FILES = ("*.toml", "*.py", "*.md", "Makefile", "LICENSE", "*.cff", ".ci")
TESTS = Path(__file__).parents[1]  # pytest loads two plugins of this folder
NOTHING_COLLECTED = 5  # pytest's status


@dataclass(frozen=True, slots=True)
class Ran:
    """What came of a run of tests.

    Attributes:
        status: Pytest's exit status; None if it ran out of time.
        output: The end of what it printed.
        seconds: How long it took.
    """

    status: int | None
    output: str
    seconds: float

    @property
    def is_green(self) -> bool:
        """Whether all tests passed, or none was there to run."""
        return self.status in (0, NOTHING_COLLECTED)

    @property
    def first_failure(self) -> str:
        """The line of the first test that failed; else how the tests ended, such as by a crash."""
        if self.is_green or self.status is None:
            return ""
        lines = [one for one in self.output.splitlines() if one.startswith(("FAILED", "ERROR"))]
        return lines[0].split(" - ")[0] if lines else f"pytest ended with status {self.status}"


class TreeCopy:
    """A tree in a temporary folder; compiled code that is cached there stays there."""

    def __init__(self, root: Path) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="mutants-"))
        self._running: subprocess.Popen[str] | None = None
        self.root = self._folder / "tree"
        self.root.mkdir()
        for part in PARTS:
            if (root / part).is_dir():
                shutil.copytree(root / part, self.root / part, symlinks=True)
        for path in {path for pattern in FILES for path in root.glob(pattern)}:
            if path.is_dir():
                shutil.copytree(path, self.root / path.name)
            else:
                shutil.copy2(path, self.root / path.name)
        links = self.root / "build" / "typing"  # as the build maps the folders to packages
        links.mkdir(parents=True, exist_ok=True)
        for name in ("plugins", "robot_models", "trees"):
            link = links / f"executive_{name}"
            if (self.root / name).is_dir() and not link.is_symlink():
                link.symlink_to(self.root / name)
        _compile([self.root / part for part in CODE])
        if (root.parent / "shared").is_dir():  # measured data beside the repository
            (self._folder / "shared").symlink_to((root.parent / "shared").resolve())
        if (self.root / "setup.py").is_file():  # the entry points are those of the copy
            words = [sys.executable, "setup.py", "-q", "egg_info"]
            subprocess.run(words, cwd=self.root, check=True, capture_output=True)

    def __enter__(self) -> "TreeCopy":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the tests that still run, and remove the copy."""
        if self._running is not None and self._running.poll() is None:
            os.killpg(self._running.pid, signal.SIGKILL)
        shutil.rmtree(self._folder, ignore_errors=True)

    def run(
        self,
        tests: Sequence[str],
        limit_s: float,
        fresh_compiled: bool = False,
        variables: Mapping[str, str] = MappingProxyType({}),
    ) -> Ran:
        """Run tests up to the first that fails.

        Args:
            tests: What pytest is given.
            limit_s: Time after which the tests are ended.
            fresh_compiled: Whether to compile everything anew, apart from the caches of the copy:
                the cache of a function does not notice a change of what it calls.
            variables: Added to the environment.
        """
        paths = (self.root, self.root / "build" / "typing", TESTS)
        environment = os.environ | {
            **variables,
            "PYTHONPATH": os.pathsep.join([*map(str, paths), *_other_paths()]),
            "PYTHONDONTWRITEBYTECODE": "1",  # a second mutant in one second would go unnoticed
        }
        environment.pop("NUMBA_CACHE_DIR", None)
        with tempfile.TemporaryDirectory(dir=self._folder) as compiled:
            if fresh_compiled:
                environment["NUMBA_CACHE_DIR"] = compiled
            words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
            begun_s = time.monotonic()
            started = subprocess.Popen(
                words,
                cwd=self.root,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                start_new_session=True,
            )
            self._running = started
            try:
                output, _ = started.communicate(timeout=limit_s)
                status: int | None = started.returncode
            except subprocess.TimeoutExpired:
                os.killpg(started.pid, signal.SIGKILL)  # with the processes that tests started
                output, _ = started.communicate()
                status = None
        return Ran(status, output[-4000:], time.monotonic() - begun_s)

    def run_only(self, tests: Sequence[str], limit_s: float, fresh_compiled: bool = False) -> Ran:
        """Run single tests by their names, file by file, up to the first that fails."""
        files = dict.fromkeys(test.partition("::")[0] for test in tests)
        selection = self._folder / "selection.json"
        selection.write_text(json.dumps(list(tests)), encoding="utf-8")
        variables = {"MUTANTS_SELECTION": str(selection)}
        words = ["-p", "mutants.selection", *files]
        return self.run(words, limit_s, fresh_compiled, variables)

    def with_source(self, file: str, source: bytes) -> "_Planted":
        """Return a context in which a file of the copy has another source."""
        return _Planted(self.root / file, source)


def _compile(folders: Sequence[Path]) -> None:
    """Compile sources once; each compiled file holds the hash of its source and is checked by it.

    So no process compiles them again, and no fault goes unnoticed, whatever the time of its file.
    """
    for folder in folders:
        if folder.is_dir():
            checked = py_compile.PycInvalidationMode.CHECKED_HASH
            compileall.compile_dir(folder, quiet=2, invalidation_mode=checked)


def _other_paths() -> list[str]:
    """Return the paths of imports that do not lead to the original tree."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return [path for path in paths if path and not (Path(path) / "executive").exists()]


class _Planted:
    """Put the old source back, with its time, so that compiled code is valid again."""

    def __init__(self, path: Path, source: bytes) -> None:
        self._path, self._source = path, source

    def __enter__(self) -> None:
        self._old, self._stat = self._path.read_bytes(), self._path.stat()
        self._path.write_bytes(self._source)

    def __exit__(self, *_: object) -> None:
        self._path.write_bytes(self._old)
        os.utime(self._path, ns=(self._stat.st_atime_ns, self._stat.st_mtime_ns))
