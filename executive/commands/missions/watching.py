"""The options by which a mission can be watched while it runs, and the ports that they choose."""

from typing import Annotated

import typer

_GROOT_PORT = 1667  # of BehaviorTree.CPP
_LIVE_PORT = 9876  # of rerun

GrootOption = Annotated[
    bool, typer.Option("--groot", help="Let Groot2 and btview on this computer watch the tree.")
]
GrootPortOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        max=65534,
        metavar="PORT",
        help=f"Port of --groot on 127.0.0.1, and the next one: {_GROOT_PORT} by default.",
        show_default=False,
    ),
]
LiveOption = Annotated[
    bool, typer.Option("--live", help="Show the mission in a rerun viewer while it runs.")
]
LivePortOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        max=65534,
        metavar="PORT",
        help=f"Port of --live on 127.0.0.1: {_LIVE_PORT} by default.",
        show_default=False,
    ),
]


def groot_port_of(groot: bool, port: int | None) -> int | None:
    """Return the port for Groot2; None if nobody is to watch. A port alone asks for it, too."""
    return port or (_GROOT_PORT if groot else None)


def live_port_of(live: bool, port: int | None) -> int | None:
    """Return the port of the viewer; None if nobody is to watch. A port alone asks for it, too."""
    return port or (_LIVE_PORT if live else None)


def groot_told(port: int) -> str:
    """Return what a person is told about the port for Groot2."""
    return f"Groot2 and btview connect with 127.0.0.1, port {port}"
