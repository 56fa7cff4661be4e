"""`executive run`: a mission from start to report."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from executive.commands.console import check_output, one_of, say
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
    WallOption,
)
from executive.commands.missions.starting import carried_out, startable
from executive.commands.missions.watching import (
    GrootOption,
    GrootPortOption,
    LiveOption,
    LivePortOption,
    watchers,
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
    from executive.tree.language import MissionFile
    from executive.tree.override import Override

_RUNNERS = ("inline", "thread", "process")
# Options that go with a machine, and those that go with `--dry`.
_OF_MACHINE = (
    "record",
    "real_time",
    "record_log",
    "stones",
    "wall",
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
    wall: WallOption = None,
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
    check_output("--record-log", record_log, ".mcap")
    watched = watchers(groot=groot, groot_port=groot_port, live=live, live_port=live_port)
    with startable():
        from executive.mission.options import Options
        from executive.mission.preset_answers import preset_answers
        from executive.mission.run import Run

        overrides = [*_of_wall(wall), *(set_ or ()), *_folder_of(stones)]
        description = _description(mission, overrides, machine)
        preset = preset_answers(answer_ or (), description)
        options = Options(
            seed=seed,
            run_dir=run_dir,
            record=record,
            record_log=record_log,
            real_time=real_time or machine is not None,
            apart=real_time,
            runner=runner,
            answer=preset.answer,
            choices=preset.choices,
            attended=attended,
            pause_on_failure=pause_on_failure,
            groot=watched.groot,
            live=watched.live,
        )
        made = Run(description, options)
    raise typer.Exit(carried_out(made, watched, quiet=quiet, as_json=as_json))


def _description(
    mission: str, overrides: Sequence["Override"], machine: str | None
) -> "MissionFile":
    """Load the mission, with what the options say of its wall, stones and machine."""
    from executive.mission.selections import model_of
    from executive.tree.load import load_mission

    settings = list(overrides)
    if machine is not None:
        settings = [*_wire_to(machine, model_of(load_mission(mission, ()))), *settings]
    return load_mission(mission, settings, is_for_here=True)


def _refuse(names: Iterable[str], given: Mapping[str, object], why: str) -> None:
    for name in names:
        if given[name] is not None and given[name] is not False:
            raise ConfigError(f"--{name.replace('_', '-')}: {why}; leave it out")


def _of_wall(wall: Path | None) -> "list[Override]":
    if wall is None:
        return []
    from executive.commands.walls.wall_of_mission import wall_of_mission

    settings, unused = wall_of_mission(wall)
    if unused:
        say(f"{wall}: {', '.join(unused)}: for `executive place` alone; not used here")
    return settings


def _folder_of(stones: Path | None) -> list[str]:
    if stones is None:
        return []
    return [f"robot.site.stones.folder={json.dumps(str(stones.resolve()))}"]


def _wire_to(machine: str, model: str) -> list[str]:
    """Return the settings of a robot behind the wire, for the machine that the mission is for."""
    return ["robot.plugin=wire", f"robot.model={json.dumps(model)}", f"robot.address={machine}"]
