"""The map of what tests reach: recorded once, brought up to date, and asked for a fault's tests.

It lies outside the project. A test file is recorded anew if it changed, or if a source changed that
one of its tests reaches.
"""

import ast
import hashlib
import json
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from mutants.fault import Fault
from mutants.tree_copy import LANE, TreeCopy

PARALLEL = ("--numprocesses", "auto", "--dist", "loadfile")
_MOST_S = 7200.0


@dataclass(frozen=True, slots=True)
class MappedTest:
    """A test that passes without any fault.

    Attributes:
        name: Its name in pytest.
        seconds: Its processor time while it was recorded [s].
        reached: The lines of each source that it reaches, as the bits of a number.
    """

    name: str
    seconds: float
    reached: dict[str, int]

    @property
    def file(self) -> str:
        """The file that defines it."""
        return self.name.partition("::")[0]

    def reaches(self, file: str, lines: Iterable[int]) -> bool:
        """Return whether it reaches one of some lines."""
        bits = self.reached.get(file, 0)
        return any(bits >> line & 1 for line in lines)


class ReachMap:
    """Which tests of the fast lane reach a line."""

    def __init__(self, tests: Sequence[MappedTest]) -> None:
        self.tests = tests

    def tests_of(self, fault: Fault, source: bytes, near: Sequence[str]) -> list[MappedTest]:
        """Return the tests that reach a fault: those near to it first, then the cheapest files.

        The other tests of these files follow: what a fixture of a module or session reaches is
        recorded for the first test alone that asks for it, and any of them may look at its answer.
        What a module does while it is imported is not the doing of one test: for such a fault,
        they are the tests that reach a function of its file, and others may notice it, too.

        Args:
            source: Of the fault's file, without the fault.
            near: Files and folders of tests to begin with.
        """
        bodies = _bodies(source)
        lines = bodies.intersection(fault.lines(source)) or bodies
        found = [test for test in self.tests if test.reaches(fault.file, lines)]
        cost: dict[str, float] = {}
        for test in found:
            cost[test.file] = cost.get(test.file, 0.0) + test.seconds
        far = {file: not any(Path(file).is_relative_to(n) for n in near) for file in cost}
        reaching = {test.name for test in found}
        beside = [one for one in self.tests if one.file in cost and one.name not in reaching]

        def order(test: MappedTest) -> tuple[bool, float, str]:
            return far[test.file], cost[test.file], test.file

        return [*sorted(found, key=order), *sorted(beside, key=order)]


def is_at_import(fault: Fault, source: bytes) -> bool:
    """Return whether a fault shows while its module is imported, such as in a default."""
    return not _bodies(source).intersection(fault.lines(source))


def _bodies(source: bytes) -> set[int]:
    """Return the lines of the statements in functions."""
    return {
        line
        for function in ast.walk(ast.parse(source))
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        for statement in function.body
        for line in range(statement.lineno, (statement.end_lineno or 0) + 1)
    }


def up_to_date(folder: Path, copy: TreeCopy) -> ReachMap:
    """Return the map that a folder holds, after recording what it lacks."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "reach.json"
    held = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    old, tests = held.get("hashes", {}), held.get("tests", {})
    hashes = {
        file.relative_to(copy.root).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for part in ("executive", "plugins", "tests")
        for file in sorted((copy.root / part).rglob("*.py"))
    }
    changed = {file for file in {*old, *hashes} if old.get(file) != hashes.get(file)}
    stale = {file for file in changed if fnmatch(file, "tests/*test_*.py")}
    stale |= {
        name.partition("::")[0] for name, test in tests.items() if changed & test["reached"].keys()
    }
    tests = {name: test for name, test in tests.items() if name.partition("::")[0] not in stale}
    absent = sorted(f for f in stale if f in hashes and "benchmarks" not in Path(f).parts)
    if absent:
        tests |= _recorded(copy, absent)
        path.write_text(json.dumps({"hashes": hashes, "tests": tests}), encoding="utf-8")
    return ReachMap(
        [
            MappedTest(
                name, test["seconds"], {f: int(bits, 16) for f, bits in test["reached"].items()}
            )
            for name, test in tests.items()
        ]
    )


def _recorded(copy: TreeCopy, files: Sequence[str]) -> dict[str, dict[str, object]]:
    """Run the fast tests of some files, and return what each of them reaches."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["-p", "mutants.reach", "-m", LANE, "--maxfail=100000", *PARALLEL, *files]
        copy.run(words, _MOST_S, variables={"MUTANTS_REACH": folder})
        answer: dict[str, dict[str, object]] = {}
        for part in sorted(Path(folder).glob("*.json")):
            answer |= json.loads(part.read_text(encoding="utf-8"))
    return answer
