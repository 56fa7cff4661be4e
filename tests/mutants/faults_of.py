"""All faults that can be planted in a file, and a random choice of those of a tree."""

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mutants.fault import Fault, Span
from mutants.operators import mistakes

FOLDERS = ("executive", "plugins")
TESTS_THAT_SHIP = "executive/testing/"  # a fault in a test is no fault of the product
_LOGGED = {"debug", "info", "warning", "warn", "error", "exception", "critical", "log", "print"}
_LOGGED |= {"echo", "secho"}
_WORDS = {"description", "help", "title", "reason", "name"}


class _Nodes(ast.NodeVisitor):
    """Collect the nodes that may be changed, each with the statement around it.

    Left out are texts that people read: annotations, decorators, f-strings, what is raised or
    logged, descriptions; blocks that only type checkers run; and assertions, `strict` of `zip`
    among them.
    """

    def __init__(self) -> None:
        self.found: list[tuple[ast.expr | ast.stmt, ast.stmt]] = []
        self._statement: ast.stmt | None = None

    def visit(self, node: ast.AST) -> None:
        if isinstance(node, ast.If) and _is_for_others(node):
            return
        outer = self._statement
        if isinstance(node, ast.stmt):
            self._statement = node
        if self._statement is not None and isinstance(node, ast.expr | ast.stmt | ast.Slice):
            self.found.append((node, self._statement))  # type: ignore[arg-type]
        super().visit(node)
        self._statement = outer

    def visit_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.visit(default)
        for statement in node.body:
            self.visit(statement)

    visit_AsyncFunctionDef = visit_FunctionDef

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in _LOGGED or name in {"cast", "TypeVar", "njit"}:
            return
        self.visit(node.func)
        for argument in node.args:
            self.visit(argument)
        for keyword in node.keywords:
            if keyword.arg not in _WORDS and (name, keyword.arg) != ("zip", "strict"):
                self.visit(keyword.value)

    def _nothing(self, node: ast.AST) -> None:
        return

    visit_JoinedStr = visit_Raise = visit_Import = visit_ImportFrom = visit_Assert = _nothing


@dataclass(frozen=True, slots=True)
class Candidate:
    """A node, the statement around it, and a wrong form of it."""

    node: ast.expr | ast.stmt
    statement: ast.stmt
    kind: str
    wrong: ast.AST


def candidates(source: bytes) -> list[Candidate]:
    """Return what may be done wrong in a source, in the order of its lines."""
    lines = source.decode().splitlines()
    nodes = _Nodes()
    for statement in ast.parse(source).body:
        nodes.visit(statement)
    return [
        Candidate(node, statement, kind, wrong)
        for node, statement in nodes.found
        if "pragma: no cover" not in lines[statement.lineno - 1] and not _is_logged(node)
        for kind, wrong in mistakes(node)
    ]


def _is_for_others(node: ast.If) -> bool:
    """Return whether a block is for type checkers, or for running the file as a script."""
    condition = ast.dump(node.test)
    return "TYPE_CHECKING" in condition or "__main__" in condition


def _is_logged(node: ast.AST) -> bool:
    """Return whether a statement only writes to a log or a terminal."""
    call = node.value if isinstance(node, ast.Expr) else None
    function = call.func if isinstance(call, ast.Call) else None
    return getattr(function, "attr", getattr(function, "id", "")) in _LOGGED


def fault_of(file: str, source: bytes, one: Candidate) -> Fault | None:
    """Return the fault, or None if its text would not be read as it is meant."""
    old, new = one.node, one.wrong
    if isinstance(old, ast.If | ast.While):  # the header alone is rewritten, never the body
        assert isinstance(new, ast.If | ast.While)
        old, new = old.test, new.test
    text = ast.unparse(ast.fix_missing_locations(new))
    span, around = Span.of(old, source), Span.of(one.statement, source)
    for words in (text, f"({text})"):
        fault = Fault(file, old.lineno, one.kind, span, words, around)
        if _is_meant(fault, source, new):
            return fault
    return None


def _is_meant(fault: Fault, source: bytes, wrong: ast.AST) -> bool:
    """Return whether the changed source holds the wrong node where the right one was."""
    try:
        tree = ast.parse(fault.planted(source))
        ast.parse(fault.exposed(source))
    except SyntaxError:
        return False
    expected = ast.dump(wrong)
    return any(
        getattr(node, "lineno", None) == fault.line and ast.dump(node) == expected
        for node in ast.walk(tree)
    )


def files_of(root: Path, only: Sequence[str]) -> list[str]:
    """Return the sources of a tree, or those of them that lie at or under some paths."""
    found = sorted(
        path.relative_to(root).as_posix()
        for folder in FOLDERS
        for path in (root / folder).rglob("*.py")
    )
    found = [file for file in found if not file.startswith(TESTS_THAT_SHIP)]
    wanted = [Path(path).as_posix() for path in only]
    return [f for f in found if not wanted or any(f == w or f.startswith(f"{w}/") for w in wanted)]


def drawn(root: Path, only: Sequence[str], count: int, seed: int) -> Iterator[Fault]:
    """Yield faults at random, none twice: a file by its length, then one of its faults.

    A file's faults are sought only once it is drawn; its length is nearly their number.
    """
    rng = np.random.default_rng(seed)
    files = files_of(root, only)
    weights = np.array([(root / file).stat().st_size for file in files], dtype=float)
    left: dict[str, list[Candidate]] = {}
    while count and weights.sum() > 0:
        i = int(rng.choice(len(files), p=weights / weights.sum()))
        file = files[i]
        source = (root / file).read_bytes()
        if file not in left:
            left[file] = candidates(source)
        if not left[file]:
            weights[i] = 0.0
            continue
        fault = fault_of(file, source, left[file].pop(int(rng.integers(len(left[file])))))
        if fault is not None:
            count -= 1
            yield fault
