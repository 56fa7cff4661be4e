"""The options by which a mission can be watched while it runs, and the ports that they choose."""

from dataclasses import dataclass
from typing import Annotated, Any

import typer

_GROOT_PORT = 1667  # of BehaviorTree.CPP
_LIVE_PORT = 9876  # of rerun


def _port(of: str, default: int, also: str = "") -> Any:
    """Return the option of a port of 127.0.0.1."""
    told = f"Port of {of} on 127.0.0.1{also}: {default} by default."
    return typer.Option(min=1, max=65534, metavar="PORT", help=told, show_default=False)


GrootOption = Annotated[
    bool, typer.Option("--groot", help="Let Groot2 and btview on this computer watch the tree.")
]
GrootPortOption = Annotated[int | None, _port("--groot", _GROOT_PORT, ", and the next one")]
LiveOption = Annotated[
    bool, typer.Option("--live", help="Show the mission in a rerun viewer while it runs.")
]
LivePortOption = Annotated[int | None, _port("--live", _LIVE_PORT)]


@dataclass(frozen=True, slots=True)
class Watchers:
    """Ports of 127.0.0.1 at which a mission can be watched; None where nobody is to watch.

    Attributes:
        groot: For Groot2 and btview, with the next one.
        live: For a rerun viewer.
    """

    groot: int | None
    live: int | None


def watchers(*, groot: bool, groot_port: int | None, live: bool, live_port: int | None) -> Watchers:
    """Return what the options of `run` and of `resume` ask for; a port alone asks for it, too."""
    return Watchers(
        groot_port or (_GROOT_PORT if groot else None), live_port or (_LIVE_PORT if live else None)
    )


def groot_told(port: int) -> str:
    """Return what a person is told about the port for Groot2."""
    return f"Groot2 and btview connect with 127.0.0.1, port {port}"
