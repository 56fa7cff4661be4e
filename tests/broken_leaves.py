"""Break each leaf in turn, and tell whether a test notices: the table of leaves, red or green.

In a copy of the tree, `raise RuntimeError` is put first into the leaf's `run` or `check`. Then the
tests run that should notice. Green means that no test lets this leaf do its work. A quarter of a
minute to ten minutes a leaf.
"""

import argparse
import ast
import json
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mutants.tree_copy import Ran, TreeCopy

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
    made.add_argument("--timeout", type=float, default=1800, metavar="S", help="of a leaf's tests")
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


def word_of(ran: Ran) -> str:
    """Return whether tests noticed; tests that do not end have."""
    if ran.status is None:
        return "red (timed out)"
    return "green" if ran.is_green else "red"


def main(words: Sequence[str] | None = None) -> int:
    command = parser()
    given = command.parse_args(words)
    leaves = leaves_of(given.root)
    if unknown := set(given.leaves) - {leaf.name for leaf in leaves}:
        command.error(f"no leaf {', '.join(sorted(unknown))}")
    leaves = [leaf for leaf in leaves if not given.leaves or leaf.name in given.leaves]
    rows = []
    with TreeCopy(given.root) as copy:
        tests = [test for test in TESTS if (copy.root / test).is_dir()]
        ran = copy.run(tests, given.timeout)
        if not ran.is_green:
            command.error(f"{' '.join(tests)} fail without any broken leaf:\n{ran.output}")
        for leaf in leaves:
            source = (copy.root / leaf.file).read_text(encoding="utf-8")
            with copy.with_source(leaf.file, leaf.broken(source).encode()):
                ran = copy.run(tests, given.timeout)
            rows.append({"leaf": leaf.name, "tests": word_of(ran), "first": ran.first_failure})
            print(f"{leaf.name:20} {word_of(ran):6} {ran.first_failure}", file=sys.stderr)
    green = [row["leaf"] for row in rows if row["tests"] == "green"]
    print(f"{len(rows) - len(green)} of {len(rows)} leaves turn the tests red", file=sys.stderr)
    if given.json:
        print(json.dumps(rows, indent=1))
    return int(bool(green))


if __name__ == "__main__":
    sys.exit(main())
