"""Break each leaf in turn, and tell whether a test notices: the table of leaves, red or green.

In a copy of the tree, `raise RuntimeError` is put first into the leaf's `run` or `check`. Then the
tests of leaves run, those files first that name it, and then those of missions, up to the first
failure. Green means that no test lets this leaf do its work. On an idle core it takes a minute for
all files without a fault, and some seconds a leaf; one that no test of leaves notices ten minutes.
"""

import argparse
import ast
import json
import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from mutants.baseline import Baseline, RedWithoutFaultError
from mutants.tree_copy import TreeCopy

ROOT = Path(__file__).parents[1]
GROUP = "executive.behaviour.v1"
VERBS = ("run", "check")
TESTS = ("tests/behaviours", "tests/mission", "tests/missions")
PLANTED = 'raise RuntimeError("this leaf is broken")'
USAGE = """examples:
  python tests/broken_leaves.py
  python tests/broken_leaves.py IsHolding PlanPlacement --json

exit status: 0 if breaking any leaf turns the tests red, 1 if one stays green, 2 if the input is
wrong or tests fail without any broken leaf"""


def parser() -> argparse.ArgumentParser:
    """Return the command line."""
    made = argparse.ArgumentParser(
        description=__doc__, epilog=USAGE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("leaves", nargs="*", metavar="LEAF", help="default: all")
    made.add_argument(
        "--timeout", type=float, default=1800, metavar="S", help="of tests without a fault [s]"
    )
    made.add_argument("--json", action="store_true", help="write the answer as JSON")
    made.add_argument("--root", type=Path, default=ROOT, help="of the tree (default: this one)")
    return made


@dataclass(frozen=True, slots=True)
class Leaf:
    """A shipped leaf: its name in missions, its file from the root, and its class."""

    name: str
    file: str
    class_name: str

    def broken(self, source: str) -> str:
        """Return the source with an exception first in the leaf's verb.

        Raises:
            ValueError: If the class defines neither `run` nor `check`.
        """
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ClassDef) and node.name == self.class_name:
                for verb in node.body:
                    if isinstance(verb, ast.FunctionDef) and verb.name in VERBS:
                        return _with_first(source, verb)
        raise ValueError(f"{self.file}: {self.class_name} defines neither run nor check")


def _with_first(source: str, verb: ast.FunctionDef) -> str:
    """Put the exception before the first statement that is no docstring."""
    has_docstring = ast.get_docstring(verb) is not None
    body = verb.body[1:] if has_docstring else verb.body
    lines = source.splitlines(keepends=True)
    first = body[0] if body else verb.body[0]
    at = first.lineno - 1 if body else (first.end_lineno or first.lineno)
    lines.insert(at, f"{' ' * first.col_offset}{PLANTED}\n")
    return "".join(lines)


def leaves_of(root: Path) -> list[Leaf]:
    """Return the leaves that pyproject.toml names, in its order."""
    groups = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    points: Mapping[str, str] = groups["project"]["entry-points"][GROUP]
    made = []
    for name, point in points.items():
        module, _, class_name = point.partition(":")
        made.append(Leaf(name, f"{module.replace('.', '/')}.py", class_name))
    return made


@dataclass(frozen=True, slots=True)
class Row:
    """What became of one broken leaf: whether its tests turned red, and the first that did."""

    leaf: str
    tests: str
    first: str

    def __str__(self) -> str:
        return f"{self.leaf:20} {self.tests:15} {self.first}".rstrip()


def naming(leaf: Leaf, root: Path) -> list[str]:
    """Return the files of tests of leaves that name a leaf's class, the shortest first."""
    word = re.compile(rf"\b{leaf.class_name}\b")
    texts = {path: path.read_text(encoding="utf-8") for path in (root / TESTS[0]).glob("test_*.py")}
    found = [path for path, text in texts.items() if word.search(text)]
    found.sort(key=lambda path: (len(texts[path]), path))
    return [path.relative_to(root).as_posix() for path in found]


def judged(leaf: Leaf, copy: TreeCopy, baseline: Baseline, nearest: Sequence[str]) -> Row:
    """Break a leaf and run the tests, the nearest first, up to the first failure.

    Args:
        leaf: The leaf.
        copy: Where it is broken.
        baseline: What tests take without a fault.
        nearest: Files of tests that hold all those which name this leaf; they run without a fault
            once for all leaves, for importing takes longer than most of them.

    Raises:
        RedWithoutFaultError: If tests fail without the broken leaf.
    """
    source = (copy.root / leaf.file).read_text(encoding="utf-8")
    first = naming(leaf, copy.root)
    rooms = [[tests] for tests in TESTS if (copy.root / tests).exists()]
    for tests, without_fault in [(first, nearest)] * bool(first) + [(one, one) for one in rooms]:
        limit_s = baseline.limit_s(copy, without_fault)
        with copy.with_source(leaf.file, leaf.broken(source).encode()):
            ran = copy.run(tests, limit_s)
        if not ran.is_green:  # tests that no longer end have noticed, too
            word = "red (timed out)" if ran.status is None else "red"
            return Row(leaf.name, word, ran.first_failure)
    return Row(leaf.name, "green", "")


def main(words: Sequence[str] | None = None) -> int:
    command = parser()
    given = command.parse_args(words)
    leaves = leaves_of(given.root)
    if unknown := set(given.leaves) - {leaf.name for leaf in leaves}:
        command.error(f"no leaf {', '.join(sorted(unknown))}")
    leaves = [leaf for leaf in leaves if not given.leaves or leaf.name in given.leaves]
    rows = []
    baseline = Baseline(given.timeout)
    with TreeCopy(given.root) as copy:
        nearest = sorted({file for leaf in leaves for file in naming(leaf, copy.root)})
        try:
            for leaf in leaves:
                rows.append(judged(leaf, copy, baseline, nearest))
                print(rows[-1], file=sys.stderr, flush=True)
        except RedWithoutFaultError as error:
            command.error(str(error))
    green = [row for row in rows if row.tests == "green"]
    print(f"{len(rows) - len(green)} of {len(rows)} leaves turn the tests red", file=sys.stderr)
    if given.json:
        print(json.dumps([asdict(row) for row in rows], indent=1))
    return int(bool(green))


if __name__ == "__main__":
    sys.exit(main())
