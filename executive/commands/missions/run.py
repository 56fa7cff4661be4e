"""`executive run`: a mission from start to report."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, one_of, say
from executive.commands.missions.dry import DEFAULT_FAILURES, Asked, Draws, Wanted, run_dry
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
from executive.commands.options import (
    ByTreeOption,
    JsonOption,
    MissionArgument,
    SeedOption,
    SetOption,
)
from executive.errors import ConfigError

_RUNNERS = ("inline", "thread", "process")


def run(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    mission: MissionArgument,
    set_: SetOption = None,
    seed: SeedOption = 1,
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
        str | None, typer.Option(help="Where long computations run: inline, thread or process.")
    ] = None,
    answer_: Annotated[
        list[str] | None,
        typer.Option(
            "--answer",
            help="Answer the mission's questions: yes, no, or one of a question's choices; may be "
            "repeated.",
        ),
    ] = None,
    machine: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Drive the machine that listens there, such as one of `executive simulate`, in "
            "real time: unix:PATH or 127.0.0.1:PORT.",
        ),
    ] = None,
    attended: Annotated[
        bool,
        typer.Option(
            "--attended",
            help="Without a terminal, let questions wait for `executive ctl RUN answer`.",
        ),
    ] = False,
    pause_on_failure: Annotated[
        bool,
        typer.Option(
            "--pause-on-failure",
            help="Pause when an action fails, until `executive ctl RUN skip`, retry or resume.",
        ),
    ] = False,
    groot: GrootOption = False,
    groot_port: GrootPortOption = None,
    live: LiveOption = False,
    live_port: LivePortOption = None,
    dry: Annotated[
        bool,
        typer.Option(
            "--dry", help="Run the tree alone: leaves are mocked, and an hour takes milliseconds."
        ),
    ] = False,
    mocks: Annotated[
        Path | None,
        typer.Option(help="With --dry: a file of what leaves do, and of what is expected."),
    ] = None,
    failures: Annotated[
        float | None,
        typer.Option(
            min=0.0, max=1.0, help="With --dry: probability that a mocked action fails.  [0.1]"
        ),
    ] = None,
    runs: Annotated[
        int | None, typer.Option(min=1, help="With --dry: number of runs, each with the next seed.")
    ] = None,
    at_least: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT",
            min=0.0,
            max=100.0,
            help="With --dry: fail if the runs take fewer of the tree's branches.",
        ),
    ] = None,
    by_tree: ByTreeOption = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Run a mission to its end and write its report.

    Example: executive run pick_and_place --seed 3 --set robot.site.stones.count=3
    """
    if runner is not None:
        one_of("--runner", runner, _RUNNERS)
    of_dry: dict[str, object] = {
        "mocks": mocks,
        "failures": failures,
        "runs": runs,
        "at-least": at_least,
    }
    of_dry |= {"by-tree": by_tree}
    if dry:
        of_machine: dict[str, object] = {
            "record": record,
            "real-time": real_time,
            "record-log": record_log,
        }
        of_machine |= {"stones": stones, "runner": runner, "machine": machine}
        of_machine |= {"attended": attended, "pause-on-failure": pause_on_failure}
        of_machine |= {"groot": groot, "groot-port": groot_port}
        of_machine |= {"live": live, "live-port": live_port}
        _refuse(of_machine, "a dry run has no machine")
        asked = Asked(mission, tuple(set_ or ()), tuple(answer_ or ()), run_dir, mocks)
        choice = Draws(seed, runs or 1, DEFAULT_FAILURES if failures is None else failures)
        wanted = Wanted(at_least, by_tree, quiet, as_json)
        raise typer.Exit(run_dry(asked, choice, wanted))
    _refuse(of_dry, "it belongs to --dry")

    with startable():
        from executive.mission.options import Options
        from executive.mission.preset_answers import preset_answers
        from executive.mission.progress import progress
        from executive.mission.run import Run
        from executive.mission.selections import model_of
        from executive.tree.load import load_mission

        settings = [*(set_ or ()), *_folder_of(stones)]
        if machine is not None:
            settings = [*_wire_to(machine, model_of(load_mission(mission, ()))), *settings]
        description = load_mission(mission, settings, is_for_here=True)
        preset = preset_answers(answer_ or (), description)
        options = Options(
            seed=seed,
            run_dir=run_dir,
            record=record,
            record_log=record_log,
            real_time=real_time or machine is not None,
            runner=runner,
            answer=preset.answer,
            choices=preset.choices,
            attended=attended,
            pause_on_failure=pause_on_failure,
            groot=groot_port_of(groot, groot_port),
            live=live_port_of(live, live_port),
        )
        made = Run(description, options)
    if options.groot is not None:
        say(groot_told(options.groot))
    with progress(quiet=quiet) as after_tick:
        result = made.execute(after_tick, say)
    say(result.summary)
    say(f"  report     {result.folder.report}")
    if as_json:
        answer(result.report)
    raise typer.Exit(result.exit_status)


def _refuse(options: Mapping[str, object], why: str) -> None:
    for option, value in options.items():
        if value is not None and value is not False:
            raise ConfigError(f"--{option}: {why}; leave it out")


def _folder_of(stones: Path | None) -> list[str]:
    if stones is None:
        return []
    return [f"robot.site.stones.folder={json.dumps(str(stones.resolve()))}"]


def _wire_to(machine: str, model: str) -> list[str]:
    """Return the settings of a robot behind the wire, for the machine that the mission is for."""
    return ["robot.plugin=wire", f"robot.model={json.dumps(model)}", f"robot.address={machine}"]
