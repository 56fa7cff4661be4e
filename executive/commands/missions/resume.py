"""`executive resume`: a run that was cut off goes on."""

from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.missions.starting import startable
from executive.commands.missions.watching import (
    GrootOption,
    GrootPortOption,
    LiveOption,
    LivePortOption,
    groot_port_of,
    groot_told,
    live_port_of,
)
from executive.commands.options import JsonOption, RunArgument


def resume(
    run_dir: RunArgument,
    groot: GrootOption = False,
    groot_port: GrootPortOption = None,
    live: LiveOption = False,
    live_port: LivePortOption = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Go on with a run that was cut off.

    It was killed, crashed, or lost its power. The journal is followed without moving anything, the
    world is observed anew, and what was under way is verified, redone, asked about, or fails, as
    each leaf declares.

    Example: executive resume runs/pick_and_place-20260101-120000
    """
    with startable():
        from executive.mission.progress import progress
        from executive.mission.resume import resumed_run

        shown_at = groot_port_of(groot, groot_port)
        made = resumed_run(run_dir, groot=shown_at, live=live_port_of(live, live_port))
    if shown_at is not None:
        say(groot_told(shown_at))
    with progress(quiet=quiet) as after_tick:
        result = made.execute(after_tick, say)
    say(result.summary)
    say(f"  report     {result.folder.report}")
    if as_json:
        answer(result.report)
    raise typer.Exit(result.exit_status)
