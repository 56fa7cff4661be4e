"""`executive compare`: two runs side by side, or two campaigns on the same seeds."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption
from executive.errors import ConfigError

OneArgument = Annotated[Path, typer.Argument(metavar="RUN", help="A run's or campaign's folder.")]
OtherArgument = Annotated[Path, typer.Argument(metavar="RUN", help="Another of the same kind.")]


def compare(one: OneArgument, other: OtherArgument, as_json: JsonOption = False) -> None:
    """Compare two runs, or two campaigns.

    Of two runs: settings, outcome, metrics, timings, and the first difference of the journals. Of
    two campaigns: paired differences of every metric, on the seeds that both have.

    Example: executive compare runs/monday runs/tuesday
    """
    from executive.campaign.execution.folder import CampaignFolder

    campaigns = [CampaignFolder(folder).results.is_file() for folder in (one, other)]
    if any(campaigns) and not all(campaigns):
        of = one if campaigns[0] else other
        raise ConfigError(f"{of} is the folder of a campaign, and the other one is not")
    if all(campaigns):
        _campaigns(one, other, as_json)
    else:
        _runs(one, other, as_json)


def _runs(one: Path, other: Path, as_json: bool) -> None:
    from executive.campaign.reporting.runs.comparison_text import comparison_answer, comparison_text
    from executive.campaign.reporting.runs.read_run import read_run
    from executive.campaign.reporting.runs.run_comparison import compare_runs

    comparison = compare_runs(read_run(one), read_run(other))
    for damage in (damage for run in comparison.runs for damage in run.damages):
        say(f"warning: {damage}")
    if as_json:
        answer(comparison_answer(comparison))
    else:
        print(comparison_text(comparison))


def _campaigns(one: Path, other: Path, as_json: bool) -> None:
    from executive.campaign.reporting.campaign_comparison import (
        campaign_differences,
        differences_answer,
        differences_text,
    )

    found = campaign_differences(one, other)
    if as_json:
        answer(differences_answer(found))
    else:
        print(differences_text(found))
