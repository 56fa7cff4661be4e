"""Estimates of metrics over the runs of a cell."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from executive.campaign.figures.cell import Levels, Samples, Shares
from executive.campaign.figures.figures import Estimate, Interval
from executive.campaign.figures.intervals.quantile import quantile, quantile_interval
from executive.campaign.figures.intervals.share import clustered
from executive.campaign.figures.row import Row

_QUANTILES = {"median": 0.5, "p90": 0.9, "p95": 0.95}
_NOTHING = (math.nan, Interval(math.nan, math.nan))

Statistics = dict[str, tuple[float, Interval]]


def estimates_of(
    name: str, cells: Mapping[Levels, Sequence[Row]], measured: Mapping[Levels, Shares | Samples]
) -> Iterator[Estimate]:
    """Yield the estimate of a metric in each cell.

    Args:
        name: The metric.
        cells: Runs by levels.
        measured: What the metric says in each cell.
    """
    for levels, rows in cells.items():
        found = measured[levels]
        if isinstance(found, Shares):
            yield _share(name, levels, rows, found)
        else:
            yield _values(name, levels, rows, found)


def _share(name: str, levels: Levels, rows: Sequence[Row], shares: Shares) -> Estimate:
    hits, of = int(shares.hits.sum()), int(shares.of.sum())
    share = (hits / of, clustered(shares.hits, shares.of)) if of else _NOTHING
    return _estimate(name, levels, rows, {"share": share}, (hits, of, shares.assumed))


def _values(name: str, levels: Levels, rows: Sequence[Row], samples: Samples) -> Estimate:
    values = samples.values
    statistics: Statistics = {
        statistic: (
            quantile(values, probability),
            quantile_interval(values, samples.seeds, probability),
        )
        for statistic, probability in _QUANTILES.items()
    }
    largest, smallest = (
        (float(np.max(values)), float(np.min(values))) if len(values) else (math.nan, math.nan)
    )
    statistics["max"] = (largest, Interval(largest, math.nan))
    statistics["min"] = (smallest, Interval(math.nan, smallest))
    return _estimate(name, levels, rows, statistics, (0, len(values), 0))


def _estimate(
    name: str,
    levels: Levels,
    rows: Sequence[Row],
    statistics: Statistics,
    counts: tuple[int, int, int],
) -> Estimate:
    hits, of, assumed = counts
    return Estimate(
        metric=name,
        levels=dict(levels),
        runs=len(rows),
        without_answer=sum(not row.has_answer for row in rows),
        measured=sum(name in row.measurements for row in rows),
        hits=hits,
        of=of,
        statistics=statistics,
        assumed=assumed,
        problems=sum(name in row.problems for row in rows),
    )
