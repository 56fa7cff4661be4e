"""The command line: a verb is a function with typer's annotations, one file a verb.

A verb imports whatever is heavy within its function, so that `--help` answers at once.

Exit status: 0 done; 1 the mission failed or was stopped; 2 the input is wrong; 3 the robot or a
plugin failed and was brought to a safe stop. People's text goes to standard error, `--json` answers
to standard output.
"""

import contextlib
import os
import sys
from collections.abc import Callable
from importlib import metadata
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from executive.commands.campaigns.campaign import campaign
from executive.commands.campaigns.compare import compare
from executive.commands.campaigns.report import report
from executive.commands.clouds.align import align
from executive.commands.clouds.register import register
from executive.commands.clouds.segment import segment
from executive.commands.clouds.survey import survey
from executive.commands.console import say
from executive.commands.grasps.grasp import grasp
from executive.commands.logs.compare_estimators import compare_estimators
from executive.commands.logs.estimate import estimate
from executive.commands.missions.check import check
from executive.commands.missions.coverage import coverage
from executive.commands.missions.ctl import ctl
from executive.commands.missions.import_ import import_mission
from executive.commands.missions.journal import journal
from executive.commands.missions.replay import replay
from executive.commands.missions.resume import resume
from executive.commands.missions.run import run
from executive.commands.missions.schema import schema
from executive.commands.missions.show import show
from executive.commands.missions.simulate import simulate
from executive.commands.missions.words import words
from executive.commands.plugins.doctor import doctor
from executive.commands.plugins.list import list_plugins
from executive.commands.plugins.new import new_plugin
from executive.commands.plugins.show import show_plugin
from executive.commands.plugins.test import hold_plugin
from executive.commands.stones.objects import objects
from executive.errors import ExecutiveError, RobotError
from executive.registry import VERBS, installed, load_verb


class _Verbs(TyperGroup):
    """The verbs of this package, and those of installed plugins: each is imported when it is asked
    for.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        return [*super().list_commands(ctx), *(verb.name for verb in installed(VERBS))]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in {verb.name for verb in installed(VERBS)}:
            return super().get_command(ctx, cmd_name)
        alone = typer.Typer(
            add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
        )
        alone.command(cmd_name)(load_verb(cmd_name))
        return typer.main.get_command(alone)


app = typer.Typer(
    name="executive",
    cls=_Verbs,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
plugins_app = typer.Typer(
    help="What is installed, by capability.", no_args_is_help=True, rich_markup_mode=None
)
app.add_typer(plugins_app, name="plugins")
_VERBS: dict[str, Callable[..., None]] = {
    "run": run,
    "resume": resume,
    "ctl": ctl,
    "replay": replay,
    "journal": journal,
    "check": check,
    "coverage": coverage,
    "show": show,
    "simulate": simulate,
    "import": import_mission,
    "schema": schema,
    "words": words,
    "campaign": campaign,
    "report": report,
    "compare": compare,
    "segment": segment,
    "register": register,
    "align": align,
    "survey": survey,
    "grasp": grasp,
    "objects": objects,
    "estimate": estimate,
    "compare-estimators": compare_estimators,
}
_PLUGIN_VERBS: dict[str, Callable[..., None]] = {
    "list": list_plugins,
    "show": show_plugin,
    "doctor": doctor,
    "test": hold_plugin,
    "new": new_plugin,
}
for name, verb in _VERBS.items():
    app.command(name)(verb)
for name, verb in _PLUGIN_VERBS.items():
    plugins_app.command(name)(verb)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"executive {metadata.version('executive')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Run, check and show missions for machines that move found stones."""


def main() -> None:
    """Run the command line; an error that a user can act on is a message, not a traceback."""
    try:
        try:
            app()
        finally:
            sys.stdout.flush()  # here, where an error can be told
    except RobotError as error:
        say(f"fault: {error}")
        sys.exit(3)
    except ExecutiveError as error:
        say(str(error) if ": error: " in str(error) else f"error: {error}")
        sys.exit(2)
    except BrokenPipeError:
        _drop_output()
        sys.exit(1)
    except OSError as error:
        _drop_output()
        place = f"{error.filename}: " if error.filename else ""
        say(f"error: {place}{error.strerror or error}")
        sys.exit(2)


def _drop_output() -> None:
    """Send what is still to be printed nowhere, so that Python does not try again at its exit."""
    with contextlib.suppress(OSError, ValueError):  # an output that is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    main()
