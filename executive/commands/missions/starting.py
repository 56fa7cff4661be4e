"""What `run` and `resume` share: the start, which a signal ends at once, and the way to the end."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer

from executive.commands.console import answer, say
from executive.commands.missions.watching import Watchers, groot_told
from executive.mission.stop_signals import Aborted, stop_at_once, stopping

if TYPE_CHECKING:
    from executive.mission.run import Run


@contextmanager
def startable() -> Iterator[None]:
    """Import, read and make what a run needs; Ctrl-C, SIGTERM and SIGHUP end it at once."""
    try:
        with stopping(stop_at_once):
            yield
    except Aborted as stopped:
        say(str(stopped))
        raise typer.Exit(1) from None


def carried_out(made: "Run", watched: Watchers, *, quiet: bool, as_json: bool) -> int:
    """Carry a run out to its end, say what came of it, and return the exit status.

    Args:
        made: The run.
        watched: Where it can be watched.
        quiet: Show no progress.
        as_json: Answer with the report.
    """
    from executive.mission.progress import progress

    if watched.groot is not None:
        say(groot_told(watched.groot))
    with progress(quiet=quiet) as after_tick:
        result = made.execute(after_tick, say)
    say(result.summary)
    say(f"  report     {result.folder.report}")
    if as_json:
        answer(result.report.payload())
    return result.exit_status
