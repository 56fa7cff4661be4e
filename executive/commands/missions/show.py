"""`executive show`: a mission's tree."""

from typing import Annotated

import typer

from executive.commands.console import answer, one_of
from executive.commands.options import JsonOption, MissionArgument, SetOption


def show(
    mission: MissionArgument,
    set_: SetOption = None,
    as_: Annotated[
        str, typer.Option("--as", help="text, dot, or xml (BehaviorTree.CPP 4, for Groot2).")
    ] = "text",
    as_json: JsonOption = False,
) -> None:
    """Print a mission's tree.

    With --json the whole mission is printed, all layers of settings resolved.

    Example: executive show relocate --as dot
    """
    form = one_of("--as", as_, ("text", "dot", "xml"))

    from executive.tree.export import export
    from executive.tree.load import load_mission
    from executive.tree.resolved import resolved_document

    description = load_mission(mission, set_ or ())
    if as_json:
        answer(resolved_document(description))
    else:
        print(export(description, form))
