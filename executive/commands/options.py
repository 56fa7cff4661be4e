"""Options and arguments that several verbs share; each means the same everywhere."""

from pathlib import Path
from typing import Annotated

import typer

JsonOption = Annotated[
    bool, typer.Option("--json", help="Answer as JSON on standard output, for programs.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="CAPABILITY.FIELD=VALUE",
        help="Change a setting, or a plugin by CAPABILITY.plugin=NAME; may be repeated.",
    ),
]
SeedOption = Annotated[
    int, typer.Option(min=0, help="Seed of all random numbers; equal seeds give equal results.")
]
MissionArgument = Annotated[
    str, typer.Argument(metavar="MISSION", help="A mission file, or the name of a shipped one.")
]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN_DIR", help="Folder of the run.")]
ByTreeOption = Annotated[
    bool,
    typer.Option("--by-tree", help="Count what several calls of one tree have taken together."),
]
CloudArgument = Annotated[
    Path,
    typer.Argument(
        metavar="CLOUD", help="PLY, PCD, LAS, LAZ, E57 or XYZ file, in metres, z roughly up."
    ),
]
SourceArgument = Annotated[
    Path,
    typer.Argument(
        metavar="SOURCE",
        help="The cloud to move: PLY, PCD, LAS, LAZ, E57 or XYZ; or a folder of them, of which "
        "each is laid over the target.",
    ),
]
TargetArgument = Annotated[Path, typer.Argument(metavar="TARGET", help="The cloud to lay it over.")]
BothOption = Annotated[
    Path | None,
    typer.Option(
        help="PLY, PCD, LAS, LAZ or E57 file for both, one colour each; if accepted; of a folder "
        "of clouds, a folder, which is gone on with."
    ),
]
CropOption = Annotated[
    str | None,
    typer.Option(
        metavar="AREA",
        help="Look at x,y,radius or x_low,y_low,x_high,y_high alone [m]; of two clouds, in the "
        "target.",
    ),
]
CropSourceOption = Annotated[
    str | None,
    typer.Option(metavar="AREA", help="The same in the source, in its own coordinates."),
]
WidestOption = Annotated[
    float | None,
    typer.Option(
        min=1,
        max=100_000,
        metavar="METRES",
        help="Take a cloud that is up to so wide to be in metres; 500 without this.",
    ),
]


def settings(set_: list[str] | None, **plugins: str | None) -> tuple[str, ...]:
    """Return what `--set` says, with the short forms such as `--method` before it.

    Args:
        set_: The values of `--set`.
        plugins: Plugin names by capability, as short options gave them; None if they did not.
    """
    chosen = (f"{capability}.plugin={name}" for capability, name in plugins.items() if name)
    return (*chosen, *(set_ or ()))
