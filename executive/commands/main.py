"""The command line: one sub-command a verb; whatever is heavy is imported inside the command that
needs it.

Exit status: 0 done; 1 the mission failed or was stopped; 2 the input is wrong; 3 the robot or a
plugin failed and was brought to a safe stop. People's text goes to standard error, `--json` answers
to standard output.
"""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from executive.commands.align import align
from executive.commands.compare_estimators import compare_estimators
from executive.commands.estimate import estimate
from executive.commands.grasp import grasp
from executive.commands.objects import objects
from executive.commands.single_clouds import register, segment


class _Verbs(TyperGroup):
    """The verbs written below, and those that installed plugins bring: each is imported when it is
    asked for.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        from executive.registry import VERBS, installed

        return [*super().list_commands(ctx), *(verb.name for verb in installed(VERBS))]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        from executive.registry import VERBS, installed, load_verb

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
    help="Run, check and show missions for machines that move found stones.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
plugins_app = typer.Typer(
    help="What is installed, by capability.", no_args_is_help=True, rich_markup_mode=None
)
app.add_typer(plugins_app, name="plugins")
app.command()(segment)
app.command()(register)
app.command()(align)
app.command()(grasp)
app.command()(objects)
app.command()(estimate)
app.command("compare-estimators")(compare_estimators)

MissionArgument = Annotated[
    str, typer.Argument(metavar="MISSION", help="A mission file, or the name of a shipped one.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="K=V", help="Override a setting: robot.site.stones.count=3."),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Answer on standard output, for machines.")
]


@app.command()
def run(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    mission: MissionArgument,
    set_: SetOption = None,
    seed: Annotated[int, typer.Option(min=0, help="All chance of the run follows from it.")] = 1,
    run_dir: Annotated[
        Path | None, typer.Option(help="Folder for the run; a new one under runs/ by default.")
    ] = None,
    record: Annotated[
        bool, typer.Option("--record", help="Write recording.rrd for the viewer.")
    ] = False,
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Tick on the wall clock, not in lock-step.")
    ] = False,
    record_log: Annotated[
        Path | None,
        typer.Option(
            help="Write what the robot measures to an MCAP log, for `executive estimate`."
        ),
    ] = None,
    stones: Annotated[
        Path | None, typer.Option(help="Folder of meshes for the simulated stones.")
    ] = None,
    runner: Annotated[
        str | None, typer.Option(help="Where long verbs run: inline, thread or process.")
    ] = None,
    answer: Annotated[
        str | None, typer.Option(help="Answer the mission's questions: yes or no.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Run a mission to its end and write its report."""
    from executive.mission.progress import progress
    from executive.mission.run import Options, Run
    from executive.tree.load import load_mission

    overrides = [
        *(set_ or []),
        *([f"robot.site.stones.folder={json.dumps(str(stones.resolve()))}"] if stones else []),
    ]
    description = load_mission(mission, overrides)
    options = Options(
        seed=seed,
        run_dir=run_dir,
        record=record,
        record_log=record_log,
        real_time=real_time,
        runner=_one_of("--runner", runner, ("inline", "thread", "process")),
        answer={"yes": True, "no": False, None: None}[_one_of("--answer", answer, ("yes", "no"))],
    )
    run_ = Run(description, options)
    with progress(quiet=quiet) as after_tick:
        result = run_.execute(after_tick)
    _say(result.summary)
    _say(f"  report     {result.folder.report}")
    if as_json:
        _answer(result.report)
    raise typer.Exit(result.exit_status)


@app.command()
def check(mission: MissionArgument, set_: SetOption = None, as_json: JsonOption = False) -> None:
    """Check a mission file: every mistake at once, with its place."""
    from executive.tree.load import load_mission
    from executive.tree.problem import MissionFileError

    try:
        description = load_mission(mission, set_ or [])
    except MissionFileError as error:
        if as_json:
            _answer(
                {
                    "mission": None,
                    "problems": [str(problem) for problem in error.problems],
                    "warnings": [],
                }
            )
        raise
    for warning in description.warnings:
        _say(str(warning))
    _say(f"{description.name}: no mistake found")
    if as_json:
        warnings = [str(warning) for warning in description.warnings]
        _answer({"mission": description.name, "problems": [], "warnings": warnings})


@app.command()
def show(
    mission: MissionArgument,
    set_: SetOption = None,
    as_: Annotated[
        str, typer.Option("--as", help="text, dot, or xml (BehaviorTree.CPP 4, for Groot2).")
    ] = "text",
    as_json: JsonOption = False,
) -> None:
    """Print a mission's tree; with --json the whole mission, all layers of settings resolved."""
    from executive.tree.export import export
    from executive.tree.load import load_mission
    from executive.tree.resolved import resolved_document

    form = _one_of("--as", as_, ("text", "dot", "xml"))
    description = load_mission(mission, set_ or [])
    if as_json:
        _answer(resolved_document(description))
    else:
        print(export(description, str(form)))


@app.command()
def schema() -> None:
    """Print the JSON schema of mission files, built from what is installed."""
    from executive.tree.schema import mission_schema

    _answer(mission_schema())


@plugins_app.command("list")
def plugins_list(as_json: JsonOption = False) -> None:
    """List all plugins by capability; nothing of them is imported."""
    from executive.registry import CAPABILITIES, installed

    table = {
        capability: [plugin.name for plugin in installed(capability)] for capability in CAPABILITIES
    }
    if as_json:
        _answer(table)
        return
    for capability, names in table.items():
        print(f"{capability:13} {', '.join(names) or '-'}")


@plugins_app.command("show")
def plugins_show(capability: str, name: str, as_json: JsonOption = False) -> None:
    """Show one plugin: what it is, what it needs, its settings with their defaults and bounds."""
    from executive.registry import describe

    described = describe(capability, name)
    if as_json:
        _answer(described)
        return
    print(f"{capability} {name} ({described['target']}, from {described['distribution']})")
    print(f"  {described['summary']}")
    print(f"  needs: {', '.join(described['needs']) or 'nothing'}")
    for setting in described["settings"]:
        print(f"  {setting['name']:24} {setting['default']!s:16} {setting['description']}")


@plugins_app.command("doctor")
def plugins_doctor(as_json: JsonOption = False) -> None:
    """Import every plugin and say which are broken."""
    from executive.registry import diagnose

    findings = diagnose()
    broken = [finding for finding in findings if finding["problem"]]
    if as_json:
        _answer(findings)
    else:
        for finding in findings:
            print(
                f"{'broken' if finding['problem'] else 'ok':7} "
                f"{finding['capability']:13} {finding['name']}"
            )
        for finding in broken:
            print(f"warning: {finding['problem']}")
    raise typer.Exit(1 if broken else 0)


def _one_of(option: str, value: str | None, allowed: tuple[str, ...]) -> str | None:
    from executive.errors import ConfigError, did_you_mean

    if value is not None and value not in allowed:
        hint = did_you_mean(value, allowed)
        listed = (
            f" is not one of {', '.join(allowed)}" if hint.startswith(";") else f" is unknown{hint}"
        )
        raise ConfigError(f"{option}: '{value}'{listed}")
    return value


def _say(text: str) -> None:
    print(text, file=sys.stderr)


def _answer(value: Any) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False))


def main() -> None:
    """Run the command line; an error that a user can act on is a message, not a traceback."""
    from executive.errors import ExecutiveError, RobotError

    try:
        app()
    except RobotError as error:
        _say(f"fault: {error}")
        sys.exit(3)
    except ExecutiveError as error:
        _say(str(error) if ": error: " in str(error) else f"error: {error}")
        sys.exit(2)
    except BrokenPipeError:
        sys.exit(1)


if __name__ == "__main__":
    main()
