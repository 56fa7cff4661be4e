"""The command that lays one cloud over another from a guess."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

GuessOption = Annotated[
    str | None,
    typer.Option(
        metavar="POSE",
        help="Pose of the source in the target: x,y,z[,roll,pitch,yaw] (metres, degrees), "
        "or a file with a 4×4 matrix "
        "or an answer of register --json. None by default.",
    ),
]


def align(
    source: Annotated[
        Path,
        typer.Argument(metavar="SOURCE", help="The cloud to be moved: PLY, PCD, LAS, LAZ or XYZ."),
    ],
    target: Annotated[Path, typer.Argument(metavar="TARGET", help="The cloud to lay it over.")],
    method: Annotated[str | None, typer.Option(help="Name of an alignment plugin.")] = None,
    guess: GuessOption = None,
    reach: Annotated[
        float, typer.Option(min=0.01, max=10, help="Farthest points that are drawn together [m].")
    ] = 0.3,
    out: Annotated[
        Path | None, typer.Option(help="PLY file for both, one colour each; written if accepted.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Answer on standard output, for machines.")
    ] = False,
) -> None:
    """Lay one cloud over another from a guess; status 1 if no motion is to be believed."""
    from executive.clouds.reader import read_site
    from executive.commands.align_guess import read_guess
    from executive.commands.alignment_answer import alignment_answer, check_out, verdict, write_both
    from executive.commands.plugin_choice import chosen
    from executive.messages.cloud import Cloud

    check_out(out)
    T_guess, scale = read_guess(guess)
    moved, fixed = read_site(source), read_site(target)
    with chosen("alignment", method) as plugin:
        rigid = plugin.align(Cloud("target", fixed), Cloud("source", scale * moved), T_guess, reach)
    found = replace(rigid, scale=scale)  # that of the guess: an alignment is rigid
    print(verdict(found, moved, fixed), file=sys.stderr)
    write_both(out, found, moved, fixed)
    if as_json:
        print(json.dumps(alignment_answer(found), indent=2))
    raise typer.Exit(0 if found.accepted else 1)
