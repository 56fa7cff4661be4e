"""`executive report`: the report of one run, or of a campaign, made anew."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption

FolderArgument = Annotated[
    Path, typer.Argument(metavar="RUN_DIR", help="The folder of a run, or of a campaign.")
]


def report(folder: FolderArgument, as_json: JsonOption = False) -> None:
    """Write the report of a run or of a campaign.

    Example: executive report runs/monday
    """
    from executive.campaign.execution.folder import CampaignFolder

    if CampaignFolder(folder).results.is_file():
        _of_campaign(folder, as_json)
    else:
        _of_run(folder, as_json)


def _of_campaign(folder: Path, as_json: bool) -> None:
    from executive.campaign.reporting.report import FIGURES, PAGE, report_campaign

    report_campaign(folder)
    say(f"report     {folder / PAGE}")
    if as_json:
        print((folder / FIGURES).read_text(encoding="utf-8"), end="")


def _of_run(folder: Path, as_json: bool) -> None:
    from executive.campaign.reporting.runs.read_run import read_run
    from executive.campaign.reporting.runs.run_report import report_run, run_answer

    run = read_run(folder)
    for damage in run.damages:
        say(f"warning: {damage}")
    if as_json:  # for programs: needs no package of the extra `reports`
        answer(run_answer(run))
    else:
        say(f"report     {report_run(run)}")
