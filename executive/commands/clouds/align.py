"""`executive align`: one cloud over another, from a guess."""

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.clouds.view import ViewOption
from executive.commands.options import (
    BothOption,
    CropOption,
    CropSourceOption,
    JsonOption,
    SetOption,
    SourceArgument,
    TargetArgument,
    WidestOption,
    settings,
)

if TYPE_CHECKING:
    from executive.messages.alignment import Alignment

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
    crop: CropOption = None,
    crop_source: CropSourceOption = None,
    widest: WidestOption = None,
    out: BothOption = None,
    as_json: JsonOption = False,
    view: ViewOption = False,
) -> None:
    """Lay clouds over another one, from a guess.

    Exit status 1 says that no motion was accepted, or not that of each cloud of the folder.

    Example: executive align stone.ply drone.ply --guess 1.2,-3.4,0,0,0,35
    """
    from executive.commands.chosen import chosen
    from executive.commands.clouds.guess import read_guess
    from executive.commands.clouds.overlay import Overlay
    from executive.interfaces.alignment import Aligner
    from executive.messages.cloud import Cloud
    from executive.tree.choices import Choices

    overlay = Overlay(source, target, crop, crop_source, widest, out, as_json, view)
    overlay.check()
    T_guess, scale = read_guess(guess)
    set_words = settings(set_, alignment=method)
    choices = Choices(("alignment",), set_words)
    asked = {"set": list(set_words), "guess": T_guess.tolist(), "scale": scale, "reach": reach}
    with chosen(Aligner, choices) as aligner:

        def lay(fixed: Cloud, moved: Cloud) -> "Alignment":
            scaled = Cloud(moved.frame, scale * moved.points)
            rigid = aligner.align(fixed, scaled, T_guess, reach)
            return replace(rigid, scale=scale)  # the motion is rigid: the scale is the guess's

        status = overlay.run(lay, asked)
    raise typer.Exit(status)
