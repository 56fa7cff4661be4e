"""`executive resume`: a run that was cut off goes on."""

import typer

from executive.commands.missions.run_options import QuietOption
from executive.commands.missions.starting import carried_out, startable
from executive.commands.missions.watching import (
    GrootOption,
    GrootPortOption,
    LiveOption,
    LivePortOption,
    watchers,
)
from executive.commands.options import JsonOption, RunArgument


def resume(
    run_dir: RunArgument,
    groot: GrootOption = False,
    groot_port: GrootPortOption = None,
    live: LiveOption = False,
    live_port: LivePortOption = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Go on with a run that was cut off.

    It was killed, crashed, or lost its power. The journal is followed without moving anything, the
    world is observed anew, and what was under way is verified, redone, asked about, or fails, as
    each leaf declares.

    Example: executive resume runs/pick_and_place-20260101-120000
    """
    watched = watchers(groot=groot, groot_port=groot_port, live=live, live_port=live_port)
    with startable():
        from executive.mission.resume import resumed_run

        made = resumed_run(run_dir, groot=watched.groot, live=watched.live)
    raise typer.Exit(carried_out(made, watched, quiet=quiet, as_json=as_json))
