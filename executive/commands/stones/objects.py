"""`executive objects`: what is in a run's object database, also while the mission runs."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer
from executive.commands.options import JsonOption


def objects(
    run_dir: Annotated[
        Path, typer.Argument(metavar="RUN_DIR", help="A run's folder, finished or under way.")
    ],
    export: Annotated[
        Path | None,
        typer.Option(help="New folder for one PLY file a stone, in the map, and poses.csv."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """List the stones of a run.

    It says where they are and what happened to them, also while the mission runs.

    Example: executive objects runs/relocate-1 --export stones
    """
    from executive.commands.chosen import chosen
    from executive.commands.stones.answer import object_answer, table
    from executive.commands.stones.database import choices_of, database_of
    from executive.commands.stones.export import export_objects
    from executive.interfaces.objects import ObjectDatabase

    path = database_of(run_dir)
    with chosen(ObjectDatabase, choices_of(run_dir)) as database:
        database.open(str(path), read_only=True)
        known = [(stone, database.history(stone.id)) for stone in database.stones()]
    if export:
        export_objects(export, known)
    if as_json:
        answer({"stones": [object_answer(stone, history) for stone, history in known]})
    else:
        print(table(known))
