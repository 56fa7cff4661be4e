"""The command line: a verb is a function with typer's annotations, one file a verb.

A verb is imported when it is asked for, and whatever is heavy within its function, so that each
answers at once, and `--help` too.

Exit status: 0 done; 1 the mission failed or was stopped; 2 the input is wrong; 3 the robot or a
plugin failed and was brought to a safe stop. People's text goes to standard error, `--json` answers
to standard output.
"""

import contextlib
import os
import sys
from collections.abc import Mapping
from importlib import metadata
from typing import Annotated, Any, ClassVar

import typer

from executive.commands.console import say
from executive.commands.verbs import Verbs, command_of
from executive.errors import ExecutiveError, RobotError
from executive.registry import VERBS, load_verb, names


class _Verbs(Verbs):
    """The verbs of this package, and those of installed plugins."""

    functions: ClassVar[Mapping[str, str]] = {
        "run": "missions.run:run",
        "resume": "missions.resume:resume",
        "ctl": "missions.ctl:ctl",
        "replay": "missions.replay:replay",
        "journal": "missions.journal:journal",
        "check": "missions.check:check",
        "coverage": "missions.coverage:coverage",
        "show": "missions.show:show",
        "simulate": "missions.simulate:simulate",
        "import": "missions.import_:import_mission",
        "schema": "missions.schema:schema",
        "words": "missions.words:words",
        "campaign": "campaigns.campaign:campaign",
        "report": "campaigns.report:report",
        "compare": "campaigns.compare:compare",
        "segment": "clouds.segment:segment",
        "register": "clouds.register:register",
        "align": "clouds.align:align",
        "changes": "clouds.changes:changes",
        "convert": "clouds.convert:convert",
        "survey": "clouds.survey:survey",
        "grasp": "grasps.grasp:grasp",
        "objects": "stones.objects:objects",
        "place": "walls.place:place",
        "estimate": "logs.estimate:estimate",
        "calibrate": "logs.calibrate:calibrate",
        "compare-estimators": "logs.compare_estimators:compare_estimators",
    }

    def list_commands(self, ctx: Any) -> list[str]:
        return [*super().list_commands(ctx), *names(VERBS)]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name in self.functions or cmd_name not in names(VERBS):
            return super().get_command(ctx, cmd_name)
        return command_of(cmd_name, load_verb(cmd_name))


class _PluginVerbs(Verbs):
    """The verbs of `executive plugins`."""

    functions: ClassVar[Mapping[str, str]] = {
        "list": "plugins.list:list_plugins",
        "show": "plugins.show:show_plugin",
        "doctor": "plugins.doctor:doctor",
        "test": "plugins.test:hold_plugin",
        "new": "plugins.new:new_plugin",
    }


app = typer.Typer(
    name="executive",
    cls=_Verbs,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
plugins_app = typer.Typer(
    cls=_PluginVerbs,
    help="What is installed, by capability.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.add_typer(plugins_app, name="plugins")


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
