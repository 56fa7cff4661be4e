"""`executive campaign`: many runs, compared with statistics."""

import shlex
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.campaigns.pool import pool_of
from executive.commands.console import answer, one_of, say
from executive.commands.options import JsonOption, SetOption
from executive.errors import ConfigError
from executive.extras import MissingExtraError

if TYPE_CHECKING:
    from executive.campaign.description.campaign import Campaign
    from executive.campaign.engine import Plan
    from executive.campaign.execution.pool import Pool
    from executive.campaign.execution.progress import Progress
    from executive.campaign.trial import Status

FAILED = "failed"  # every status without an answer


def campaign(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    what: Annotated[
        str,
        typer.Argument(
            metavar="CAMPAIGN",
            help="A campaign file, a mission file, the name of a shipped mission, or the folder of "
            "an earlier campaign.",
        ),
    ],
    seeds: Annotated[
        str | None,
        typer.Option(help="Seeds: 1:20 with the last one, or 1:5,31; needed for a mission."),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CAPABILITY.FIELD=A,B,C",
            help="A setting or a plugin that is varied; every combination is run with every seed.",
        ),
    ] = None,
    set_: SetOption = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Runs side by side; the number of cores by default.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on the workers of a dask scheduler: tcp://…"),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for results; a new one under campaigns/ by default."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the results in the folder.")
    ] = False,
    again: Annotated[
        list[str] | None,
        typer.Option(
            metavar="STATUS",
            help="With --resume: repeat runs that were crashed, killed, timed_out, out_of_memory, "
            "or failed (all of these).",
        ),
    ] = None,
    time_limit: Annotated[
        str | None, typer.Option(help="Time limit of a run: 20 min; 60 min by default.")
    ] = None,
    memory_limit: Annotated[
        str | None, typer.Option(help="Memory limit of a run: 4 GB; 8 GB by default.")
    ] = None,
    dry: Annotated[
        bool, typer.Option("--dry", help="Check everything and list the runs; begin none.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Run many missions, and compare variants.

    A mission is run with many seeds and variants; figures are reported with their intervals. Each
    run has a process of its own; one that crashes or hangs costs that run, which counts as failed.
    A campaign that is stopped or killed goes on with --resume. Exit status: 0 if every bound is
    met; 1 if one is missed, or if it was stopped; 2 if the input is wrong or the campaign could
    not go on.

    Example: executive campaign relocate --seeds 1:20 --vary alignment.plugin=gicp,point_to_plane
    """
    from executive.campaign.description.load import load_campaign
    from executive.campaign.description.options import CampaignOptions

    statuses = _statuses(again or (), resume)
    folder = _folder(what, out, resume)
    options = CampaignOptions(seeds, tuple(set_ or ()), tuple(vary or ()), time_limit, memory_limit)
    asked = load_campaign(what, options, _command())
    for warning in asked.warnings:
        say(warning)
    if dry:
        _list(asked, as_json)
        return

    from executive.campaign.engine import Plan

    plan = Plan(folder or _fresh(asked.name), resume, statuses)
    progress = _run(asked, plan, pool_of(jobs, scheduler), quiet)
    raise typer.Exit(_conclude(asked, plan.folder, progress, as_json))


def _statuses(again: "list[str] | tuple[str, ...]", resume: bool) -> "tuple[Status, ...]":
    from executive.campaign.trial import Status

    if again and not resume:
        raise ConfigError("--again repeats runs of an earlier session: it needs --resume")
    failures = tuple(one for one in Status if one is not Status.DONE)
    names = tuple(one.value for one in failures)
    chosen = [one_of("--again", name, (*names, FAILED)) for name in again]
    return tuple(one for one in failures if one.value in chosen or FAILED in chosen)


def _folder(what: str, out: Path | None, resume: bool) -> Path | None:
    """Return the folder of results that was asked for; None if a new one is to be made."""
    from executive.campaign.description.load import is_campaign_folder

    folder = out or (Path(what) if is_campaign_folder(what) else None)
    if resume and folder is None:
        raise ConfigError("--resume: name the folder to go on in, by --out or instead of the file")
    if resume and folder is not None and not (folder / "results.sqlite").is_file():
        raise ConfigError(f"--resume: {folder} holds no results of a campaign")
    return folder


def _fresh(name: str) -> Path:
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")  # noqa: TID251 - names a folder, decides nothing
    stem = Path("campaigns") / f"{name}-{stamp}"
    candidates = (stem if n == 0 else Path(f"{stem}-{n}") for n in range(1000))
    return next(path for path in candidates if not path.exists())


def _command() -> str:
    """Return the command line, as a person would type it."""
    return shlex.join(["executive", *sys.argv[1:]])


def _run(asked: "Campaign", plan: "Plan", pool: "Pool", quiet: bool) -> "Progress":
    from executive.campaign.engine import run_campaign
    from executive.campaign.execution.disk_space import DiskFullError
    from executive.campaign.execution.pool import RefusedError
    from executive.commands.campaigns.progress import campaign_progress

    try:
        with campaign_progress(asked.trials, quiet=quiet) as after_change:
            return run_campaign(asked, plan, pool, after_change)
    except (DiskFullError, RefusedError):
        say("the campaign cannot go on; what has ended is kept. When the cause is removed:")
        say(f"  go on      executive campaign {shlex.quote(str(plan.folder))} --resume")
        raise


def _conclude(asked: "Campaign", folder: Path, progress: "Progress", as_json: bool) -> int:
    """Write the report, tell what came of the campaign, and return the exit status."""
    from executive.campaign.reporting.report import PAGE, summarise_campaign, write_report
    from executive.campaign.reporting.summary import document_of
    from executive.commands.campaigns.ending import ending

    report = summarise_campaign(folder, asked)
    for line in ending(folder, report, progress):
        say(line)
    page: Path | None = folder / PAGE
    try:
        write_report(folder, report)
        say(f"  report     {page}")
    except MissingExtraError as error:
        page = None
        say(f"no page was written: {error}")
    are_met = all(one.is_met for one in report.summary.figures.judgements)
    if as_json:
        paths = {"folder": str(folder), "page": None if page is None else str(page)}
        ends = {"is_complete": progress.is_complete, "are_bounds_met": are_met}
        answer({**paths, **ends, **document_of(report.summary)})
    return 0 if progress.is_complete and are_met else 1


def _list(asked: "Campaign", as_json: bool) -> None:
    """Tell what would be run."""
    from executive.commands.campaigns.progress import level_words

    cells = dict.fromkeys(level_words(trial.levels) for trial in asked.trials)
    seeds = dict.fromkeys(trial.seed for trial in asked.trials)
    say(f"{asked.name}: {len(asked.trials)} runs: {len(seeds)} seeds, {len(cells)} combinations")
    for trial in asked.trials:
        say(f"  run {trial.number}  seed {trial.seed}  {level_words(trial.levels)}".rstrip())
    if as_json:
        runs: list[dict[str, Any]] = [
            {"number": one.number, "seed": one.seed, "levels": dict(one.levels)}
            for one in asked.trials
        ]
        answer({"campaign": asked.name, "digest": asked.digest, "runs": runs})
