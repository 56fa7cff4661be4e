"""`executive plugins new`: a package with one plugin or leaf, to begin with."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption


def new_plugin(
    capability: Annotated[str, typer.Argument(help="A capability, or leaf.")],
    name: Annotated[str, typer.Argument(help="Name of the plugin and its package: steep_ground.")],
    into: Annotated[Path, typer.Option(help="Folder to make the new one in.")] = Path(),
    as_json: JsonOption = False,
) -> None:
    """Write a package that passes `plugins test`.

    Example: executive plugins new segmentation steep_ground
    """
    from executive.testing.new_package import new_package

    written = new_package(capability, name, into)
    for path in written:
        say(f"wrote {path}")
    say(f"next: pip install -e {written[0].parent}")
    if as_json:
        answer({"files": [str(path) for path in written]})
