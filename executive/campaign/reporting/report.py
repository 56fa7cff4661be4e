"""The report of a campaign: page, pictures, tables and figures, in its folder."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.load import load_asked
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.ledger import Ledger, Session
from executive.campaign.figures.calculation import figures_of
from executive.campaign.reporting.campaign_page import campaign_page
from executive.campaign.reporting.result import Result, results_of
from executive.campaign.reporting.results_table import write_tables
from executive.campaign.reporting.summary import Summary, head_of, write_summary
from executive.errors import ConfigError
from executive.extras import require_extra

PAGE = "report.html"
FIGURES = "figures.json"


@dataclass(frozen=True, slots=True)
class CampaignReport:
    """What the results of a campaign say so far: its summary, and every run that has ended."""

    summary: Summary
    results: Sequence[Result]


def report_campaign(folder: Path, campaign: Campaign | None = None) -> CampaignReport:
    """Compute the figures of a campaign from what has ended of it, and write its report.

    The files are `figures.json`, `results.csv`, `results.parquet`, `charts/*.png` and
    `report.html`. The ledger is read once.

    Args:
        folder: The campaign's folder.
        campaign: What was asked for; read from the folder if None.

    Raises:
        ConfigError: If the folder holds no results of a campaign.
        MissionFileError: If the campaign's file there can no longer be read.
        MissingExtraError: If the packages of the extra `reports` are not installed; the figures
            are written nevertheless.
    """
    report = summarise_campaign(folder, campaign)
    write_report(folder, report)
    return report


def summarise_campaign(folder: Path, campaign: Campaign | None = None) -> CampaignReport:
    """Compute the figures of a campaign, and write `figures.json` alone."""
    campaign, results, sessions = read_campaign_folder(folder, campaign)
    rows = [result.row for result in results]
    figures = figures_of(rows, campaign.metrics, campaign.bounds, campaign.comparisons)
    summary = Summary(head_of(campaign, results, sessions, figures), figures)
    write_summary(folder / FIGURES, summary)
    return CampaignReport(summary, results)


def read_campaign_folder(
    folder: Path, campaign: Campaign | None = None
) -> tuple[Campaign, list[Result], Sequence[Session]]:
    """Return what was asked for, what has ended, and the sessions that worked on it.

    The trials are those of the ledger, so that results can be read after a mission has changed.

    Raises:
        ConfigError: If the folder holds no results of a campaign.
        MissionFileError: If the campaign's file there can no longer be read.
    """
    path = CampaignFolder(folder).results
    if not path.is_file():
        raise ConfigError(f"{folder} holds no campaign: there is no {path.name}")
    with closing(Ledger(path, is_read_only=True)) as ledger:
        sessions = ledger.sessions()
        command = sessions[0].command if sessions else ""
        campaign = campaign or load_asked(folder, command)
        if ledger.digest != campaign.digest:
            campaign = replace(campaign, trials=tuple(ledger.trials()))
        campaign = replace(campaign, digest=ledger.digest or "", command=command)
        return campaign, list(results_of(campaign.trials, ledger.outcomes())), sessions


def write_report(folder: Path, report: CampaignReport) -> None:
    """Write tables, pictures and the page of a campaign into its folder.

    Raises:
        MissingExtraError: If the packages of the extra `reports` are not installed.
    """
    require_extra("the report of a campaign", "reports")
    summary, results = report.summary, report.results
    write_tables(folder, results, list(summary.campaign.factors), summary.campaign.metrics)
    page = campaign_page(folder, summary, results)
    charts = folder / "charts"
    charts.mkdir(exist_ok=True)
    for picture in page.pictures:
        picture.write(charts)
    page.write(folder / PAGE)
