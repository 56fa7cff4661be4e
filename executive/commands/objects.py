"""The command that looks into a run's object database, also while the mission runs."""

import json
from pathlib import Path
from typing import Annotated

import typer


def objects(
    run_dir: Annotated[
        Path, typer.Argument(metavar="RUN_DIR", help="A run's folder, finished or under way.")
    ],
    export: Annotated[
        Path | None,
        typer.Option(help="New folder for one PLY file a stone, in the map, and poses.csv."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Answer on standard output, for machines.")
    ] = False,
) -> None:
    """List the stones of a run: where they are, and everything that happened to them."""
    from executive.commands.objects_answer import object_answer, table
    from executive.commands.objects_export import export_objects
    from executive.commands.plugin_choice import chosen
    from executive.commands.run_objects import database_of, plugin_of

    path = database_of(run_dir)
    with chosen("objects", plugin_of(run_dir)) as database:
        database.open(str(path), read_only=True)
        known = [(stone, database.history(stone.id)) for stone in database.stones()]
    if export:
        export_objects(export, known)
    if as_json:
        print(
            json.dumps(
                {"stones": [object_answer(stone, history) for stone, history in known]}, indent=2
            )
        )
    else:
        print(table(known))
