"""The start of a run: a signal ends it at once, with a message and the status of a stopped run."""

from collections.abc import Iterator
from contextlib import contextmanager

import typer

from executive.commands.console import say
from executive.mission.stop_signals import Aborted, stop_at_once, stopping


@contextmanager
def startable() -> Iterator[None]:
    """Import, read and make what a run needs; Ctrl-C, SIGTERM and SIGHUP end it at once."""
    try:
        with stopping(stop_at_once):
            yield
    except Aborted as stopped:
        say(str(stopped))
        raise typer.Exit(1) from None
