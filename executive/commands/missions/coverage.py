"""`executive coverage`: which branches of a tree runs have taken."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import ByTreeOption, JsonOption


def coverage(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN_DIR...", help="Folders of runs of one mission, real or dry ones."
        ),
    ],
    at_least: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT",
            min=0.0,
            max=100.0,
            help="Fail if the runs have taken fewer of the tree's branches.",
        ),
    ] = None,
    by_tree: ByTreeOption = False,
    as_json: JsonOption = False,
) -> None:
    """Tell which branches of a tree runs have taken.

    A branch is a way in which a node can end, or what a modifier can do: a timeout that passes, a
    node that is left out. What the runs have never taken is listed.

    Example: executive coverage runs/monday runs/tuesday --at-least 80
    """
    from executive.coverage.by_tree import by_tree as merged
    from executive.coverage.run_folders import coverage_of
    from executive.coverage.text import coverage_answer, coverage_text

    found = coverage_of(runs)
    found = merged(found) if by_tree else found
    if as_json:
        answer(coverage_answer(found))
    else:
        print(coverage_text(found))
    if at_least is not None and found.percent < at_least:
        say(f"error: {found.percent:.1f} % of the branches were taken, not {at_least:g} %")
        raise typer.Exit(1)
