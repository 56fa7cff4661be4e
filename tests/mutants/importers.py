"""Which files of a tree import a file, directly or through others."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from mutants.related_tests import module_of

FOLDERS = ("executive", "plugins", "tests")


class Importers:
    """The imports of a tree, as its sources state them.

    Args:
        root: Of the tree.
    """

    def __init__(self, root: Path) -> None:
        files = {
            module_of(path.relative_to(root)): path.relative_to(root).as_posix()
            for folder in FOLDERS
            for path in (root / folder).rglob("*.py")
        }
        self._importing: dict[str, set[str]] = defaultdict(set)
        for file in files.values():
            for module in _imported(ast.parse((root / file).read_bytes())):
                if module in files:
                    self._importing[files[module]].add(file)

    def of(self, file: str) -> set[str]:
        """Return the files that import a file, and those that import these."""
        found: set[str] = set()
        left = [file]
        while left:
            new = self._importing[left.pop()] - found
            found |= new
            left += new
        return found - {file}


def _imported(tree: ast.Module) -> Iterator[str]:
    """Yield the modules that a source may import, wherever it does."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)
