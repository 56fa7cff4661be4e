"""Plant random faults in executive/ and plugins/, and tell which of them no test notices.

Each fault is planted in a copy of the tree, never in place. Then the tests run that concern the
file: those that mirror it, hold its contract or import it, and, if none of them fails, the fast
lane. A fault is killed if a test fails or does not end; otherwise it survives, and `not covered`
says that no test even reaches the statement. Listed equivalent mutants are left out. A fault in a
minute on an idle core; some take ten.

Left alone are docstrings, log texts, error messages, annotations, lines with `pragma: no cover`,
and the tests that ship in executive/testing. Compiled functions are changed like all others: none
of them has a second copy.
"""

import argparse
import json
import sys
import threading
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from mutants.baseline import Baseline, RedWithoutFaultError
from mutants.fault import Fault
from mutants.faults_of import drawn
from mutants.related_tests import related
from mutants.tree_copy import TreeCopy

ROOT = Path(__file__).parents[1]
USAGE = """examples:
  python tests/mutation.py --count 20
  python tests/mutation.py --seed 3 --count 100 --jobs 4 --json > mutants.json
  python tests/mutation.py --only plugins/monitoring --only executive/geometry --no-lane
  python tests/mutation.py --count 5 --list

exit status: 0 if no more survive than allowed, 1 if more do, 2 if the input is wrong or tests fail
without any fault"""
LANE = ("-m", "not mission and not slow", "tests")
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
    made.add_argument("--no-lane", action="store_true", help="skip the fast lane")
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
    """Runs the tests of faults, each worker in a copy of its own."""

    def __init__(self, root: Path, limit_s: float, has_lane: bool) -> None:
        self._root, self._has_lane = root, has_lane
        self._baseline = Baseline(limit_s)
        self._copies: list[TreeCopy] = []
        self._own = threading.local()

    def judge(self, fault: Fault) -> Verdict:
        """Plant a fault, run its tests, and return what became of it."""
        copy = self._copy()
        source = (copy.root / fault.file).read_bytes()
        stages = [*related(copy.root, fault.file), *([LANE] if self._has_lane else [])]
        status, by, seconds = SURVIVED if stages else NOT_COVERED, "", 0.0
        for stage in stages:
            try:
                limit_s = self._baseline.limit_s(copy, stage)
            except RedWithoutFaultError as error:
                status, by = NOT_JUDGED, str(error)
                break
            with copy.with_source(fault.file, fault.planted(source)):
                ran = copy.run(stage, limit_s, is_compiled(source))
            seconds += ran.seconds
            if not ran.is_green:
                status, by = TIMED_OUT if ran.status is None else KILLED, ran.first_failure
                break
        if status == SURVIVED and not self._is_reached(copy, fault, source, stages):
            status = NOT_COVERED
        where = fault.file, fault.line, fault.kind, fault.diff(source)
        return Verdict(*where, status, by, round(seconds, 1))

    def _is_reached(
        self, copy: TreeCopy, fault: Fault, source: bytes, stages: Iterable[Sequence[str]]
    ) -> bool:
        """Return whether an exception in place of the statement turns the tests red."""
        with copy.with_source(fault.file, fault.exposed(source)):
            return any(
                not copy.run(
                    stage, self._baseline.limit_s(copy, stage), is_compiled(source)
                ).is_green
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


def is_compiled(source: bytes) -> bool:
    """Return whether a file holds functions that are compiled, and cached so by their callers."""
    return b"njit" in source


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
    verdicts = []
    pool = ThreadPoolExecutor(given.jobs)
    judge = Judge(given.root, given.timeout, not given.no_lane)
    try:
        for verdict in pool.map(judge.judge, faults):
            verdicts.append(verdict)
            print(verdict, file=sys.stderr, flush=True)
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
