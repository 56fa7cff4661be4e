"""`executive align`: one cloud over another, from a guess."""

from dataclasses import replace
from typing import Annotated

import typer

from executive.commands.clouds.view import ViewOption, check_view, recording_of, show
from executive.commands.console import check_output
from executive.commands.options import (
    BothOption,
    JsonOption,
    SetOption,
    SourceArgument,
    TargetArgument,
    settings,
)

GuessOption = Annotated[
    str | None,
    typer.Option(
        metavar="POSE",
        help="Pose of the source in the target: x,y,z[,roll,pitch,yaw] (metres, degrees), "
        "or a file with a 4×4 matrix "
        "or an answer of register --json. None by default.",
    ),
]


def align(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    source: SourceArgument,
    target: TargetArgument,
    method: Annotated[
        str | None, typer.Option(help="Short for --set alignment.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    guess: GuessOption = None,
    reach: Annotated[
        float, typer.Option(min=0.01, max=10, help="Largest distance of corresponding points [m].")
    ] = 0.3,
    out: BothOption = None,
    as_json: JsonOption = False,
    view: ViewOption = False,
) -> None:
    """Lay one cloud over another, from a guess.

    Exit status 1 says that no motion was accepted.

    Example: executive align stone.ply drone.ply --guess 1.2,-3.4,0,0,0,35
    """
    from executive.clouds.coordinate_system import coordinate_system
    from executive.clouds.reader import read_site
    from executive.clouds.writer import WRITTEN
    from executive.commands.chosen import chosen
    from executive.commands.clouds.alignment_answer import alignment_view, conclude
    from executive.commands.clouds.guess import read_guess
    from executive.interfaces.alignment import Aligner
    from executive.messages.cloud import Cloud
    from executive.tree.choices import Choices

    check_output("--out", out, *WRITTEN, read=(source, target))
    check_view(view)
    T_guess, scale = read_guess(guess)
    choices = Choices(("alignment",), settings(set_, alignment=method))
    with chosen(Aligner, choices) as aligner:
        moved, fixed = read_site(source), read_site(target)
        rigid = aligner.align(
            Cloud("target", fixed), Cloud("source", scale * moved), T_guess, reach
        )
    found = replace(rigid, scale=scale)  # an alignment is rigid: the scale is that of the guess
    crs = coordinate_system(target)
    status = conclude(found, moved, fixed, out, as_json, crs)
    if view:
        show(recording_of(source, out), alignment_view(found, moved, fixed))
    raise typer.Exit(status)
