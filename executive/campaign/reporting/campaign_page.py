"""The page of a campaign: failures first, then figures."""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.page.page import Page
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.sections.differences import differences
from executive.campaign.reporting.sections.distributions import distributions
from executive.campaign.reporting.sections.failures import failures
from executive.campaign.reporting.sections.head import head_list
from executive.campaign.reporting.sections.phases import phases
from executive.campaign.reporting.sections.shares import shares
from executive.campaign.reporting.sections.tables import (
    estimate_tables,
    not_measured,
    resource_table,
)
from executive.campaign.reporting.sections.verdicts import verdicts
from executive.campaign.reporting.summary import Summary


def campaign_page(folder: Path, summary: Summary, results: Sequence[Result]) -> Page:
    """Return the page of a campaign.

    Args:
        folder: The campaign's folder, for the journals of runs that failed.
        summary: Its figures.
        results: Its finished runs.
    """
    head = summary.campaign
    cells = Cells(head.factors)
    by_cell: dict[str, list[Result]] = defaultdict(list)
    for result in results:
        by_cell[cells.name(result.trial.levels)].append(result)
    page = Page(head.name, head.description)
    page.add(head_list(head))
    page.section("Bounds", *verdicts(summary))
    page.section("Failures", *failures(folder, results, cells))
    page.section("Shares", *shares(page, summary, cells))
    page.section("Distributions", *distributions(page, summary, by_cell, cells))
    page.section("Phases", *phases(page, summary, cells))
    page.section("Paired differences", *differences(page, summary, cells))
    page.section("All figures", *estimate_tables(summary, cells))
    page.section("Resources", *([resource_table(by_cell, cells)] if results else []))
    page.section("Not measured", *not_measured(summary, results, cells))
    return page
