"""Ways to run a tree with values, and to be told its mistakes."""

from typing import Any

import pytest

from executive.tree.problem import MissionFileError
from tests.tree.values.leaves import HEADER, LEAVES


@pytest.fixture
def told(load: Any) -> Any:
    """Return the mistakes of a mission whose `main` is a sequence.

    Where the text has the mark §, a mistake at that letter begins with §.
    """

    def problems(main: str, trees: str = "") -> list[str]:
        body = "".join(f"      {line}\n" for line in main.strip("\n").splitlines())
        text = f"trees:\n  main:\n    sequence:\n{body}{trees}"
        before = (HEADER + text).partition("§")[0]
        marked = before.count("\n") + 1, len(before) - before.rfind("\n")
        try:
            load(text.replace("§", ""), leaves=LEAVES)
        except MissionFileError as error:
            return [
                ("§ " if (p.mark.line, p.mark.column) == marked else "") + p.message
                for p in error.problems
            ]
        return []

    return problems


@pytest.fixture
def run(play: Any) -> Any:
    """Run a sequence to its end, and return the play."""

    def played(main: str, trees: str = "") -> Any:
        body = "".join(f"  {line}\n" for line in main.strip("\n").splitlines())
        one = play(f"sequence:\n{body}", leaves=LEAVES, trees=trees)
        one.finish()
        return one

    return played
