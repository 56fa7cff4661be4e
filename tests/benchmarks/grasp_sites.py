"""The command line of the two benchmarks that run sites of seven stones, or lay out the table."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, numbers

RANKINGS = ("learned", "paper", "rehearsal")
SCENARIOS = ("kind", "nominal", "wet", "harsh")


def read(
    doc: str | None, usage: str, file: str, words: Sequence[str] | None
) -> tuple[argparse.Namespace, Path]:
    """Return what the command line says, and the path of the file of rows.

    Args:
        doc: The benchmark's docstring.
        usage: Examples, a line each.
        file: The file of rows in the folder that the command line names.
        words: The command line; that of the process if None.
    """
    parser = command_line(doc, usage)
    parser.add_argument("folder", type=Path, help="folder of the results; a run resumes in it")
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("table", help="lay out the table of what was run")
    run = verbs.add_parser("run", help="run sites, then lay out the table")
    run.add_argument("stones", help="`generated`, or a folder of meshes")
    run.add_argument("ranking", choices=RANKINGS)
    run.add_argument("sites", type=numbers, help="such as 3 or 1:15")
    run.add_argument("--scale", type=float, default=1.0, help="of the meshes (default: 1)")
    run.add_argument("--scenario", choices=SCENARIOS, default="nominal", help="of the world")
    given = parser.parse_args(words)
    path: Path = given.folder / file
    if given.verb == "table" and not path.is_file():
        parser.error(f"there is no {path}: run sites first")
    if given.verb == "run" and given.stones != "generated" and not Path(given.stones).is_dir():
        parser.error(f"{given.stones!r} is neither `generated` nor a folder of meshes")
    given.folder.mkdir(exist_ok=True, parents=True)
    return given, path
