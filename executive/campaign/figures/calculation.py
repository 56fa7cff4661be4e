"""From rows to figures: the whole statistics of a campaign."""

from collections.abc import Sequence

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.cell import cells_of, measured_by
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.difference import differences_of
from executive.campaign.figures.estimate import estimates_of
from executive.campaign.figures.figures import Figures
from executive.campaign.figures.judgement import judgements_of
from executive.campaign.figures.measurement import metric
from executive.campaign.figures.row import Row


def figures_of(
    rows: Sequence[Row],
    metrics: Sequence[str],
    bounds: Sequence[Bound] = (),
    comparisons: Sequence[Comparison] = (),
) -> Figures:
    """Return the figures of a campaign, in the order of its metrics and of its cells.

    Args:
        rows: Every finished trial, in any order.
        metrics: Installed names of the metrics.
        bounds: Limits on figures; metrics that only these name are estimated as well.
        comparisons: What is compared with what.

    Raises:
        UnknownPluginError: If a metric is not installed.
        BrokenPluginError: If a metric cannot be imported.
    """
    named = [*metrics, *(bound.metric for bound in bounds)]
    named += [name for comparison in comparisons for name in comparison.metrics]
    installed = {name: metric(name) for name in dict.fromkeys(named)}
    cells = cells_of(sorted(rows, key=lambda row: row.number))
    measured = {name: measured_by(name, one, cells) for name, one in installed.items()}
    estimates = tuple(
        estimate
        for name, found in measured.items()
        for estimate in estimates_of(name, cells, found)
    )
    differences = tuple(
        difference
        for comparison in comparisons
        for difference in differences_of(comparison, installed, cells, measured)
    )
    return Figures(estimates, differences, tuple(judgements_of(bounds, estimates)))
