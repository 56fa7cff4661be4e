"""`executive run`: a mission from start to report."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from executive.commands.console import answer, one_of, say
from executive.commands.missions.dry import DEFAULT_FAILURES, Asked, Draws, Wanted, run_dry
from executive.commands.missions.run_options import (
    AnswerOption,
    AtLeastOption,
    AttendedOption,
    DryOption,
    FailuresOption,
    MachineOption,
    MocksOption,
    PauseOnFailureOption,
    QuietOption,
    RealTimeOption,
    RecordLogOption,
    RecordOption,
    RunDirOption,
    RunnerOption,
    RunsOption,
    StonesOption,
)
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

if TYPE_CHECKING:
    from executive.mission.run import Run
    from executive.tree.language import MissionFile

_RUNNERS = ("inline", "thread", "process")
# Options that go with a machine, and those that go with `--dry`.
_OF_MACHINE = (
    "record",
    "real_time",
    "record_log",
    "stones",
    "runner",
    "machine",
    "attended",
    "pause_on_failure",
    "groot",
    "groot_port",
    "live",
    "live_port",
)
_OF_DRY = ("mocks", "failures", "runs", "at_least", "by_tree")


def run(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    mission: MissionArgument,
    set_: SetOption = None,
    seed: SeedOption = 1,
    run_dir: RunDirOption = None,
    record: RecordOption = False,
    real_time: RealTimeOption = False,
    record_log: RecordLogOption = None,
    stones: StonesOption = None,
    runner: RunnerOption = None,
    answer_: AnswerOption = None,
    machine: MachineOption = None,
    attended: AttendedOption = False,
    pause_on_failure: PauseOnFailureOption = False,
    groot: GrootOption = False,
    groot_port: GrootPortOption = None,
    live: LiveOption = False,
    live_port: LivePortOption = None,
    dry: DryOption = False,
    mocks: MocksOption = None,
    failures: FailuresOption = None,
    runs: RunsOption = None,
    at_least: AtLeastOption = None,
    by_tree: ByTreeOption = False,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Run a mission to its end and write its report.

    Example: executive run pick_and_place --seed 3 --set robot.site.stones.count=3
    """
    given = dict(locals())
    if dry:
        _refuse(_OF_MACHINE, given, "a dry run has no machine")
        asked = Asked(mission, tuple(set_ or ()), tuple(answer_ or ()), run_dir, mocks)
        draws = Draws(seed, runs or 1, DEFAULT_FAILURES if failures is None else failures)
        raise typer.Exit(run_dry(asked, draws, Wanted(at_least, by_tree, quiet, as_json)))
    _refuse(_OF_DRY, given, "it belongs to --dry")
    if runner is not None:
        one_of("--runner", runner, _RUNNERS)
    with startable():
        from executive.mission.options import Options
        from executive.mission.preset_answers import preset_answers
        from executive.mission.run import Run

        description = _description(mission, set_ or (), stones, machine)
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
    raise typer.Exit(_execute(made, quiet=quiet, as_json=as_json))


def _execute(made: "Run", *, quiet: bool, as_json: bool) -> int:
    """Run to the end, say what came of it, and return the exit status."""
    from executive.mission.progress import progress

    with progress(quiet=quiet) as after_tick:
        result = made.execute(after_tick, say)
    say(result.summary)
    say(f"  report     {result.folder.report}")
    if as_json:
        answer(result.report)
    return result.exit_status


def _description(
    mission: str, set_: Sequence[str], stones: Path | None, machine: str | None
) -> "MissionFile":
    """Load the mission, with what the options say of its stones and its machine."""
    from executive.mission.selections import model_of
    from executive.tree.load import load_mission

    settings = [*set_, *_folder_of(stones)]
    if machine is not None:
        settings = [*_wire_to(machine, model_of(load_mission(mission, ()))), *settings]
    return load_mission(mission, settings, is_for_here=True)


def _refuse(names: Iterable[str], given: Mapping[str, object], why: str) -> None:
    for name in names:
        if given[name] is not None and given[name] is not False:
            raise ConfigError(f"--{name.replace('_', '-')}: {why}; leave it out")


def _folder_of(stones: Path | None) -> list[str]:
    if stones is None:
        return []
    return [f"robot.site.stones.folder={json.dumps(str(stones.resolve()))}"]


def _wire_to(machine: str, model: str) -> list[str]:
    """Return the settings of a robot behind the wire, for the machine that the mission is for."""
    return ["robot.plugin=wire", f"robot.model={json.dumps(model)}", f"robot.address={machine}"]
