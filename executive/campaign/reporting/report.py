"""The report of a campaign: page, pictures, tables and figures, in its folder."""

from collections.abc import Iterable
from pathlib import Path

from executive.campaign.description.campaign import Campaign
from executive.campaign.figures.figures import Figures
from executive.campaign.reporting.campaign_page import campaign_page
from executive.campaign.reporting.result import results_of
from executive.campaign.reporting.results_table import write_tables
from executive.campaign.reporting.summary import Summary, head_of, write_summary
from executive.campaign.trial import Outcome
from executive.extras import require_extra


def write_report(
    folder: Path, campaign: Campaign, outcomes: Iterable[Outcome], figures: Figures
) -> Path:
    """Write `report.html`, `charts/*.png`, `results.csv`, `results.parquet` and `figures.json`.

    Args:
        folder: The campaign's folder, with the runs below `runs/`.
        campaign: What was asked for.
        outcomes: What came of the trials that have ended; they are read one by one.
        figures: The figures of these outcomes.

    Returns:
        The page.

    Raises:
        MissingExtraError: If the packages of the extra `reports` are not installed.
    """
    require_extra("the report of a campaign", "reports")
    results = list(results_of(campaign.trials, outcomes))
    summary = Summary(head_of(campaign, results), figures)
    write_summary(folder / "figures.json", summary)
    write_tables(folder, results, list(campaign.factors), summary.campaign.metrics)
    page = campaign_page(folder, summary, results)
    charts = folder / "charts"
    charts.mkdir(exist_ok=True)
    for picture in page.pictures:
        picture.write(charts)
    page.write(folder / "report.html")
    return folder / "report.html"
