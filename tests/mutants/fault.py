"""A planted fault: one expression or statement of a file, replaced by a wrong one."""

import ast
import difflib
from dataclasses import dataclass

REACHED = "raise RuntimeError('the planted fault is reached')"


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a source, in bytes of its UTF-8 form."""

    start: int
    end: int

    @classmethod
    def of(cls, node: ast.expr | ast.stmt, source: bytes) -> "Span":
        """Return where a node is."""
        lines = source.splitlines(keepends=True)
        starts = [0]
        for line in lines:
            starts.append(starts[-1] + len(line))
        assert node.end_lineno is not None  # ast.parse always gives it
        assert node.end_col_offset is not None
        return cls(
            starts[node.lineno - 1] + node.col_offset,
            starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def replaced(self, source: bytes, text: str) -> bytes:
        """Return the source with other text in this place."""
        return source[: self.start] + text.encode() + source[self.end :]


@dataclass(frozen=True, slots=True)
class Fault:
    """One wrong change of a file.

    Attributes:
        file: Path from the root of the tree, with slashes.
        line: Where it is.
        kind: What was done, such as `comparison`.
        span: What is replaced.
        text: What it is replaced by.
        statement: The statement around it, for telling whether the tests reach it.
    """

    file: str
    line: int
    kind: str
    span: Span
    text: str
    statement: Span

    def planted(self, source: bytes) -> bytes:
        """Return the source with the fault in it."""
        return self.span.replaced(source, self.text)

    def exposed(self, source: bytes) -> bytes:
        """Return the source with an exception in place of the statement around the fault."""
        return self.statement.replaced(source, REACHED)

    def lines(self, source: bytes) -> range:
        """Return the lines from the beginning of the statement to the end of the fault."""
        first = source.count(b"\n", 0, self.statement.start) + 1
        return range(first, source.count(b"\n", 0, self.span.end) + 2)

    def diff(self, source: bytes) -> str:
        """Return the changed lines, before and after."""
        before, after = (text.decode().splitlines() for text in (source, self.planted(source)))
        lines = list(difflib.unified_diff(before, after, n=0, lineterm=""))[3:]
        return "\n".join(lines)
