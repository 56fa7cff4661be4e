"""`executive register`: one cloud over another, without a guess."""

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
    from executive.messages.cloud import Cloud


def register(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    source: SourceArgument,
    target: TargetArgument,
    method: Annotated[
        str | None, typer.Option(help="Short for --set registration.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    crop: CropOption = None,
    crop_source: CropSourceOption = None,
    widest: WidestOption = None,
    out: BothOption = None,
    as_json: JsonOption = False,
    view: ViewOption = False,
) -> None:
    """Lay clouds over another one, without a guess.

    Exit status 1 says that no motion was accepted, or not that of each cloud of the folder.

    Example: executive register lidar.ply drone.las --out both.ply
    """
    import numpy as np

    from executive.commands.chosen import chosen
    from executive.commands.clouds.overlay import Overlay
    from executive.interfaces.registration import Registrar
    from executive.tree.choices import Choices

    overlay = Overlay(source, target, crop, crop_source, widest, out, as_json, view)
    overlay.check()
    set_words = settings(set_, registration=method)
    choices = Choices(("registration",), set_words)
    with chosen(Registrar, choices) as registrar:

        def lay(fixed: "Cloud", moved: "Cloud") -> "Alignment":
            return registrar.register(fixed, moved, np.random.default_rng(0))

        status = overlay.run(lay, {"set": list(set_words)})
    raise typer.Exit(status)
