"""Plant random faults in executive/ and plugins/, and tell which of them no test notices.

Each fault is planted in a copy of the tree, never in place. Then the tests of the fast lane run
that reach its line, the nearest and cheapest first, up to the first that fails: a map says which
these are. It is recorded on the first use (some five minutes) in a folder outside the tree, and
brought up to date where a test or what it reaches changed. If none fails, or none reaches the line,
the slow tests follow that mirror the file, hold its contract or import it, unless `--no-slow`. A
fault is killed if a test fails or does not end; otherwise it survives, and `not covered` says that
no test even reaches the statement. Listed equivalent mutants are left out.

The fast tests are collected once, and each run is a fork of the process that holds them, in which
the function has the fault; what is done at the import, or compiled, is imported anew. So a fault
costs what its tests cost: a second or two if it is killed, and up to minutes if it survives.

Left alone are docstrings, log texts, error messages, annotations, lines with `pragma: no cover`,
and the tests that ship in executive/testing. Compiled functions are changed like all others: none
of them has a second copy.
"""

import argparse
import json
import sys
import tempfile
import threading
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from mutants.baseline import Baseline, RedWithoutFaultError
from mutants.fault import Fault
from mutants.faults_of import drawn
from mutants.reach_map import MappedTest, is_at_import, up_to_date
from mutants.related_tests import related
from mutants.tree_copy import LANE, Ran, TreeCopy

ROOT = Path(__file__).parents[1]
USAGE = """examples:
  python tests/mutation.py --count 20
  python tests/mutation.py --seed 3 --count 100 --jobs 4 --json > mutants.json
  python tests/mutation.py --only plugins/monitoring --only executive/geometry --no-slow
  python tests/mutation.py --count 5 --list

exit status: 0 if no more survive than allowed, 1 if more do, 2 if the input is wrong or tests fail
without any fault"""
MAP = Path(tempfile.gettempdir()) / "executive-mutants"
GRACE_S = 60.0  # for the start of pytest, beside five times what the tests took
MOST_S = 1800.0  # tests that take longer count as hanging
CHUNK = 40  # tests of the first run: most faults are noticed by one of the nearest
KILLED, TIMED_OUT, SURVIVED, NOT_COVERED = "killed", "timed out", "survived", "not covered"
NOT_JUDGED = "not judged"  # the tests fail without the fault, too
STATUSES = (KILLED, TIMED_OUT, SURVIVED, NOT_COVERED)


def parser() -> argparse.ArgumentParser:
    """Return the command line."""
    made = argparse.ArgumentParser(
        description=__doc__, epilog=USAGE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("--seed", type=int, default=0, help="of the choice (default: 0)")
    made.add_argument("--count", type=int, default=100, help="number of faults (default: 100)")
    made.add_argument("--jobs", type=int, default=1, help="copies of the tree (default: 1)")
    made.add_argument("--only", action="append", default=[], metavar="PATH", help="file or folder")
    made.add_argument("--bound", type=float, default=0.08, help="of survivors (default: 0.08)")
    made.add_argument(
        "--timeout", type=float, default=900, metavar="S", help="of tests without a fault [s]"
    )
    made.add_argument("--no-slow", action="store_true", help="leave slow tests out")
    made.add_argument(
        "--map", type=Path, default=MAP, metavar="FOLDER", help=f"of what tests reach ({MAP})"
    )
    made.add_argument("--list", action="store_true", help="draw the faults and run nothing")
    made.add_argument("--json", action="store_true", help="write the answer as JSON")
    made.add_argument("--root", type=Path, default=ROOT, help="of the tree (default: this one)")
    return made


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of one fault.

    Attributes:
        status: `killed`, `timed out`, `survived` or `not covered`.
        by: The first test that failed.
    """

    file: str
    line: int
    kind: str
    diff: str
    status: str
    by: str
    seconds: float

    def __str__(self) -> str:
        text = f"{self.status:11}  {self.file}:{self.line}  {self.kind}  {self.seconds:.0f} s"
        text += f"  {self.by}" if self.by else ""
        return text if self.status == KILLED else f"{text}\n{self.diff}"


class Judge:
    """Runs the tests of faults, each worker in a copy of its own.

    Args:
        root: Of the tree.
        folder: Where the map is of what tests reach.
        limit_s: How long related tests may take without a fault.
        has_slow: Whether slow tests run where the fast ones notice nothing.
    """

    def __init__(self, root: Path, folder: Path, limit_s: float, has_slow: bool) -> None:
        self._root, self._has_slow = root, has_slow
        self._baseline = Baseline(limit_s)
        self._copies: list[TreeCopy] = []
        self._own = threading.local()
        self._map = up_to_date(folder, self._copy())
        self._red: set[str] = set()

    def judge(self, fault: Fault) -> Verdict:
        """Plant a fault, run its tests, and return what became of it."""
        copy = self._copy()
        copy.collect()
        source = (copy.root / fault.file).read_bytes()
        stages = related(copy.root, fault.file)
        reaching = self._map.tests_of(fault, source, [name for one in stages for name in one])
        status, by, seconds = self._by_map(copy, fault, source, reaching)
        is_mapped = bool(reaching) and not is_at_import(fault, source)
        if status == SURVIVED and (self._has_slow or not is_mapped):
            among = self._later(is_mapped)
            later = [("-m", among, *stage) for stage in stages]
            status, by, more = self._by_stages(copy, fault, source, later, bool(reaching))
            seconds += more
        where = fault.file, fault.line, fault.kind, fault.diff(source)
        return Verdict(*where, status, by, round(seconds, 1))

    def _later(self, is_mapped: bool) -> str:
        """Return the marks of the tests that run where those of the map noticed nothing."""
        if is_mapped:
            return "slow and not mission"
        return "not mission" if self._has_slow else LANE

    def _by_map(
        self, copy: TreeCopy, fault: Fault, source: bytes, tests: Sequence[MappedTest]
    ) -> tuple[str, str, float]:
        """Run the tests that reach a fault; one that fails counts if it passes without it."""
        seconds = 0.0
        left = [test for test in tests if test.name not in self._red]
        chunks = [left[:CHUNK], left[CHUNK:]]
        while chunks:
            chunk = [test for test in chunks.pop(0) if test.name not in self._red]
            if not chunk:
                continue
            limit_s = GRACE_S + 5.0 * sum(test.seconds for test in chunk)
            ran = self._ran(copy, fault, source, [test.name for test in chunk], limit_s)
            seconds += ran.seconds
            if ran.is_green:
                continue
            if ran.status is None:
                return TIMED_OUT, "", seconds
            failed = [test for test in chunk if ran.first_failure.endswith(f" {test.name}")]
            enough_s = max(limit_s, 5.0 * ran.seconds)
            without = copy.run_only([test.name for test in failed or chunk], enough_s)
            seconds += without.seconds
            if without.is_green:
                return KILLED, ran.first_failure, seconds
            red = {one.name for one in chunk if without.first_failure.endswith(one.name)}
            if not red:  # a file that cannot be collected, say
                return NOT_JUDGED, without.first_failure, seconds
            self._red |= red
            chunks.insert(0, chunk)
        return SURVIVED, "", seconds

    def _ran(
        self, copy: TreeCopy, fault: Fault, source: bytes, names: Sequence[str], limit_s: float
    ) -> Ran:
        """Run tests with a fault; again with more time where they are nearly as slow without it."""
        while True:
            with copy.with_source(fault.file, fault.planted(source)):
                ran = copy.run_only(names, limit_s)
            if ran.status is not None or limit_s > MOST_S:
                return ran
            without = copy.run_only(names, limit_s)
            if without.status is not None and 3.0 * without.seconds < limit_s:
                return ran
            limit_s *= 4.0  # the computer is busy

    def _by_stages(
        self,
        copy: TreeCopy,
        fault: Fault,
        source: bytes,
        stages: Sequence[Sequence[str]],
        is_reached: bool,
    ) -> tuple[str, str, float]:
        """Run tests by folder, for what the map does not see."""
        seconds = 0.0
        for stage in stages:
            try:
                limit_s = self._baseline.limit_s(copy, stage)
            except RedWithoutFaultError as error:
                return NOT_JUDGED, str(error), seconds
            with copy.with_source(fault.file, fault.planted(source)):
                ran = copy.run(stage, limit_s)
            seconds += ran.seconds
            if not ran.is_green:
                status = TIMED_OUT if ran.status is None else KILLED
                return status, ran.first_failure, seconds
        is_reached = is_reached or self._is_reached(copy, fault, source, stages)
        return SURVIVED if is_reached else NOT_COVERED, "", seconds

    def _is_reached(
        self, copy: TreeCopy, fault: Fault, source: bytes, stages: Iterable[Sequence[str]]
    ) -> bool:
        """Return whether an exception in place of the statement turns the tests red."""
        with copy.with_source(fault.file, fault.exposed(source)):
            return any(
                not copy.run(stage, self._baseline.limit_s(copy, stage)).is_green
                for stage in stages
            )

    def _copy(self) -> TreeCopy:
        """Return the copy of this thread."""
        if not hasattr(self._own, "copy"):
            self._own.copy = TreeCopy(self._root)
            self._copies.append(self._own.copy)
        copy: TreeCopy = self._own.copy
        return copy

    def close(self) -> None:
        """Remove the copies."""
        for copy in self._copies:
            copy.close()


def without_equivalents(faults: Iterable[Fault], root: Path) -> list[Fault]:
    """Leave out what is listed as making no difference."""
    path = root / "tests" / "mutants" / "equivalent.toml"
    listed = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    known = {(one["file"], one["diff"].strip()) for one in listed.get("mutant", ())}
    return [
        fault
        for fault in faults
        if (fault.file, fault.diff((root / fault.file).read_bytes())) not in known
    ]


def summary(verdicts: Sequence[Verdict], bound: float) -> tuple[str, bool]:
    """Return the count of each status, and whether too many survive; not covered ones do."""
    counts = Counter(one.status for one in verdicts)
    alive, judged = counts[SURVIVED] + counts[NOT_COVERED], counts.total() - counts[NOT_JUDGED]
    share = alive / judged if judged else 1.0
    text = ", ".join(
        f"{counts[name]} {name}" for name in (KILLED, TIMED_OUT, SURVIVED, NOT_COVERED)
    )
    return f"{text}: {share:.1%} of {judged} survive, allowed {bound:.0%}", share > bound


def main(words: Sequence[str] | None = None) -> int:
    command = parser()
    given = command.parse_args(words)
    if given.count < 1 or given.jobs < 1:
        command.error("--count and --jobs are 1 or more")
    drawn_faults = drawn(given.root, given.only, given.count, given.seed)
    faults = without_equivalents(drawn_faults, given.root)
    if not faults:
        command.error(f"no fault can be planted in {' '.join(given.only) or given.root}")
    if given.list:
        for fault in faults:
            print(f"{fault.file}:{fault.line}  {fault.kind}")
            print(fault.diff((given.root / fault.file).read_bytes()))
        return 0
    pool = ThreadPoolExecutor(given.jobs)
    judge = Judge(given.root, given.map, given.timeout, not given.no_slow)
    try:
        judged = [pool.submit(judge.judge, fault) for fault in faults]
        for one in as_completed(judged):
            print(one.result(), file=sys.stderr, flush=True)
        verdicts = [one.result() for one in judged]
    finally:  # also when it is interrupted
        pool.shutdown(wait=False, cancel_futures=True)
        judge.close()
    text, is_missed = summary(verdicts, given.bound)
    print(text, file=sys.stderr)
    if given.json:
        rows = [{name: getattr(one, name) for name in one.__slots__} for one in verdicts]
        print(json.dumps({"seed": given.seed, "mutants": rows, "summary": text}, indent=1))
    unjudged = sum(one.status == NOT_JUDGED for one in verdicts)
    if unjudged:
        command.error(f"{unjudged} faults are not judged: tests fail without any fault")
    return int(is_missed)


if __name__ == "__main__":
    sys.exit(main())
