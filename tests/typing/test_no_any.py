"""The signatures that authors of plugins and leaves see say what they take: `Any` says nothing."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
SEEN = ("interfaces", "messages", "events", "leaf", "testing")
FOLDERS = (*(ROOT / "executive" / name for name in SEEN), ROOT / "plugins")
# Python has no type for "whatever parameters a subclass names"; the report is JSON, read by key.
ALLOWED = {
    "executive/leaf/action.py Action.run",
    "executive/leaf/action.py Action.verify",
    "executive/leaf/action.py Condition.check",
}


def is_public(name: str) -> bool:
    return not name.startswith("_") or (name.startswith("__") and name.endswith("__"))


def annotations(node: ast.stmt) -> Iterator[ast.expr | None]:
    """Yield what a function, an attribute, a class or a named type says of types."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        given = node.args
        every = (*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg)
        yield from (one.annotation for one in every if one is not None)
        yield node.returns
    elif isinstance(node, ast.AnnAssign):
        yield node.annotation
    elif isinstance(node, ast.Assign):
        yield node.value
    elif isinstance(node, ast.ClassDef):
        yield from node.bases


def name_of(node: ast.stmt) -> str:
    if isinstance(node, ast.AnnAssign):
        return ast.unparse(node.target)
    return (
        ast.unparse(node.targets[0]) if isinstance(node, ast.Assign) else getattr(node, "name", "")
    )


def untyped(source: str) -> list[str]:
    """Return the public names of a source whose types hold `Any`."""
    found = []

    def visit(body: list[ast.stmt], within: str) -> None:
        for node in body:
            name = name_of(node)
            if not name or not is_public(name):
                continue
            words = (one for each in annotations(node) if each for one in ast.walk(each))
            if any("Any" in (getattr(one, "id", ""), getattr(one, "attr", "")) for one in words):
                found.append(within + name)
            if isinstance(node, ast.ClassDef):
                visit(node.body, f"{within}{name}.")

    visit(ast.parse(source).body, "")
    return found


def test_no_public_signature_says_any() -> None:
    files = [path for folder in FOLDERS for path in sorted(folder.rglob("*.py"))]
    assert len(files) > 300
    found = {
        f"{path.relative_to(ROOT).as_posix()} {name}"
        for path in files
        for name in untyped(path.read_text(encoding="utf-8"))
    }
    assert found == ALLOWED


def test_each_place_of_a_signature_is_looked_at() -> None:
    source = """
import typing
from typing import Any
Block = list[Any]
limit: Any = 3
def first(a: Any) -> int: ...
def second(*a: int, **b: "int") -> dict[str, typing.Any]: ...
def third(a: int) -> None:
    inner: Any = a
def _own(a: Any) -> Any: ...
class Kept(list[Any]):
    size: Any
    def __init__(self, a: Any) -> None: ...
    def _own(self) -> Any: ...
class Known:
    size: int
    def of(self, a: int) -> object: ...
"""
    assert untyped(source) == [
        *("Block", "limit", "first", "second"),
        *("Kept", "Kept.size", "Kept.__init__"),
    ]
