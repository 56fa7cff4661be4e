"""`executive register`: one cloud over another, without a guess."""

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


def register(
    source: SourceArgument,
    target: TargetArgument,
    method: Annotated[
        str | None, typer.Option(help="Short for --set registration.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    out: BothOption = None,
    as_json: JsonOption = False,
    view: ViewOption = False,
) -> None:
    """Lay one cloud over another, without a guess.

    Exit status 1 says that no motion was accepted.

    Example: executive register lidar.ply drone.las --out both.ply
    """
    import numpy as np

    from executive.clouds.coordinate_system import coordinate_system
    from executive.clouds.reader import read_site
    from executive.clouds.writer import WRITTEN
    from executive.commands.chosen import chosen
    from executive.commands.clouds.alignment_answer import alignment_view, conclude
    from executive.interfaces.registration import Registrar
    from executive.messages.cloud import Cloud
    from executive.tree.choices import Choices

    check_output("--out", out, *WRITTEN, read=(source, target))
    check_view(view)
    choices = Choices(("registration",), settings(set_, registration=method))
    with chosen(Registrar, choices) as registrar:
        fixed, moved = read_site(target), read_site(source)
        found = registrar.register(
            Cloud("target", fixed), Cloud("source", moved), np.random.default_rng(0)
        )
    crs = coordinate_system(target)
    status = conclude(found, moved, fixed, out, as_json, crs)
    if view:
        show(recording_of(source, out), alignment_view(found, moved, fixed))
    raise typer.Exit(status)
