"""Two campaigns compared on the seeds that both have, as if they were the levels of a factor."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from executive.campaign.description.campaign import Campaign
from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.figures import Difference
from executive.campaign.figures.measurement import metric
from executive.campaign.figures.row import Row
from executive.campaign.reporting.report import read_campaign_folder
from executive.campaign.reporting.sections.differences import difference, interval_of
from executive.campaign.reporting.summary import MetricWords, without_nan
from executive.errors import ConfigError
from executive.events.event import plain

_FACTOR = "campaign"


def campaign_differences(one: Path, other: Path) -> Sequence[Difference]:
    """Return the differences of the second campaign from the first, of every metric of both.

    Args:
        one: Folder of the first, which is the baseline.
        other: Folder of the second.

    Raises:
        ConfigError: If a folder holds no campaign, or no seed was run in the same cell by both.
    """
    campaigns: list[Campaign] = []
    rows: list[Row] = []
    for folder in (one, other):
        campaign, results, _ = read_campaign_folder(folder)
        campaigns.append(campaign)
        rows += [_of(result.row, folder, len(rows) + n) for n, result in enumerate(results)]
    metrics = [name for name in campaigns[0].metrics if name in campaigns[1].metrics]
    comparison = Comparison(_FACTOR, str(one), tuple(metrics))
    found = [one for one in figures_of(rows, metrics, (), [comparison]).differences if one.pairs]
    if not found:
        told = "no seed was run by both with the same levels and measured by the same metric"
        raise ConfigError(f"{one} and {other} cannot be compared: {told}")
    return found


def differences_answer(found: Sequence[Difference]) -> list[dict[str, Any]]:
    """Return the differences as JSON holds them; what cannot be said is null."""
    return [without_nan(plain(one)) for one in found]


def differences_text(found: Sequence[Difference]) -> str:
    """Return the differences for a person, cell by cell."""
    lines = [f"{found[0].level} against {found[0].baseline}"]
    for one in found:
        words = MetricWords.of(metric(one.metric))
        cell = ", ".join(f"{factor}={level}" for factor, level in one.others.items())
        lines += [
            f"  {words.title}{f' ({cell})' if cell else ''}: {difference(one, words)}"
            f" ({interval_of(one, words)}), {one.pairs} pairs,"
            f" {one.better} better, {one.worse} worse",
            f"    {one.words}",
        ]
    return "\n".join(lines)


def _of(row: Row, folder: Path, number: int) -> Row:
    return replace(row, number=number, levels={**row.levels, _FACTOR: str(folder)})
