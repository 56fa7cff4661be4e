"""A copy of the tree in which faults are planted and tests are run, apart from the original."""

import compileall
import json
import os
import py_compile
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from mutants.forks import REFUSED
from mutants.importers import Importers
from mutants.run_server import RunServer

PARTS = ("executive", "plugins", "robot_models", "trees", "tests", "docs", "build/typing")
CODE = ("executive", "plugins")
FILES = ("*.toml", "*.py", "*.md", "Makefile", "LICENSE", "*.cff", ".ci")
TESTS = Path(__file__).parents[1]  # pytest loads two plugins of this folder
LANE = "not mission and not slow"
PYTEST = ("-q", "-p", "no:cacheprovider")
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
        self._server: RunServer | None = None
        self._collected: RunServer | None = None
        self._is_collected = False
        self._planted: tuple[str, bytes] | None = None  # a file that is changed, and as it was
        self._importers: Importers | None = None
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
        for server in (self._server, self._collected):
            if server is not None:
                server.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def run(
        self,
        tests: Sequence[str],
        limit_s: float,
        variables: Mapping[str, str] = MappingProxyType({}),
    ) -> Ran:
        """Run tests up to the first that fails.

        Args:
            tests: What pytest is given.
            limit_s: Time after which the tests are ended.
            variables: Added to the environment.
        """
        if self._server is None:
            words = [sys.executable, "-m", "mutants.fork_server"]
            self._server = RunServer(words, self.root, self._environment())
        begun_s = time.monotonic()
        words = [*PYTEST, "-x", *tests]
        status, output = self._server.run({"words": words, "variables": {**variables}}, limit_s)
        return Ran(status, output, time.monotonic() - begun_s)

    def _environment(self) -> dict[str, str]:
        """Return the environment of all runs."""
        paths = (self.root, self.root / "build" / "typing", TESTS)
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join([*map(str, paths), *_other_paths()]),
            "PYTHONDONTWRITEBYTECODE": "1",  # a second mutant in one second would go unnoticed
        }
        environment.pop("NUMBA_CACHE_DIR", None)
        return environment

    def run_only(self, tests: Sequence[str], limit_s: float) -> Ran:
        """Run single tests of the fast lane by their names, up to the first that fails."""
        ran = self.run_collected(tests, limit_s)
        if ran is not None:
            return ran
        files = dict.fromkeys(test.partition("::")[0] for test in tests)
        selection = self._folder / "selection.json"
        selection.write_text(json.dumps(list(tests)), encoding="utf-8")
        variables = {"MUTANTS_SELECTION": str(selection)}
        words = ["-p", "mutants.selection", *files]
        return self.run(words, limit_s, variables)

    def collect(self) -> None:
        """Collect the fast tests once, so that `run_only` runs them in forks where it can."""
        if self._is_collected:
            return
        self._is_collected = True
        lane = ["-m", LANE, "-p", "mutants.collected", "--continue-on-collection-errors"]
        words = [sys.executable, "-m", "pytest", *PYTEST, *lane]
        self._collected = RunServer(words, self.root, self._environment())
        with suppress(ConnectionError):  # told by the first run
            self._collected.wait()

    def run_collected(self, tests: Sequence[str], limit_s: float) -> Ran | None:
        """Run tests by the process that has collected them; return None if it refuses."""
        if self._collected is None:
            return None
        file, before = self._planted or ("", b"")
        begun_s = time.monotonic()
        try:
            status, output = self._collected.run(
                {"names": [*tests], "file": file, "before": before.decode()}, limit_s
            )
        except ConnectionError:  # the tests cannot be collected
            self._collected.close()
            self._collected = None
            return None
        if status == REFUSED:
            return None
        return Ran(status, output, time.monotonic() - begun_s)

    @contextmanager
    def with_source(self, file: str, source: bytes) -> Iterator[None]:
        """Return a context in which a file of the copy has another source.

        The compiled functions of the file and of all that import it are set aside meanwhile: the
        cache of a function does not notice a change of what it calls.
        """
        files = [self.root / file]
        before = files[0].read_bytes()
        if b"njit" in before:
            if self._importers is None:
                self._importers = Importers(self.root)
            files += [self.root / other for other in sorted(self._importers.of(file))]
        with _Planted(source, files):
            self._planted = file, before
            try:
                yield
            finally:
                self._planted = None


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
    """Put the old source back, with its time, so that compiled code is valid again.

    Args:
        source: Of the first file, while it is changed.
        files: The file, and those whose compiled functions are not valid meanwhile.
    """

    def __init__(self, source: bytes, files: Sequence[Path]) -> None:
        self._path, self._source, self._files = files[0], source, files

    def __enter__(self) -> None:
        self._aside = Path(tempfile.mkdtemp(dir=self._path.parent))
        self._moved = {path: self._aside / str(i) for i, path in enumerate(self._compiled())}
        for path, aside in self._moved.items():
            path.rename(aside)
        self._old, self._stat = self._path.read_bytes(), self._path.stat()
        self._path.write_bytes(self._source)

    def __exit__(self, *_: object) -> None:
        self._path.write_bytes(self._old)
        os.utime(self._path, ns=(self._stat.st_atime_ns, self._stat.st_mtime_ns))
        for path in self._compiled():
            path.unlink()
        for path, aside in self._moved.items():
            aside.rename(path)
        self._aside.rmdir()

    def _compiled(self) -> list[Path]:
        """Return the files in which numba keeps the compiled functions of the files."""
        return [
            path
            for file in self._files
            for path in (file.parent / "__pycache__").glob(f"{file.stem}.*.nb[ic]")
        ]
