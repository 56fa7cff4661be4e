"""Paired differences between the levels of a factor, on the same seeds."""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from executive.campaign.figures.cell import Levels, Samples, Shares
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.figures import Difference, Interval
from executive.campaign.figures.intervals.pairs import (
    difference_of_shares,
    medians_by_seed,
    sign_test,
)
from executive.campaign.figures.intervals.quantile import quantile, quantile_interval
from executive.campaign.figures.row import Row
from executive.campaign.figures.verdict import Pairs, verdict_of
from executive.interfaces.metric import Metric

_NOTHING = (math.nan, Interval(math.nan, math.nan))


def differences_of(
    comparison: Comparison,
    metrics: Mapping[str, Metric],
    cells: Mapping[Levels, Sequence[Row]],
    measured: Mapping[str, Mapping[Levels, Shares | Samples]],
) -> Iterator[Difference]:
    """Yield each level's difference from the baseline, for each combination of other levels.

    Args:
        comparison: What is compared with what.
        metrics: Metrics by name.
        cells: Runs by levels.
        measured: What each metric says in each cell.
    """
    seeds = {levels: {row.seed for row in rows} for levels, rows in cells.items()}
    for name in comparison.metrics:
        for base, levels in _opposed(comparison, cells):
            match measured[name][levels], measured[name][base]:
                case Shares() as own, Shares() as other:
                    found = _of_shares(own, other, comparison.margin, metrics[name])
                case Samples() as own, Samples() as other:
                    found = _of_values(own, other, comparison.margin, metrics[name])
            both = len(seeds[levels] & seeds[base])
            yield _difference(comparison, name, levels, both, found)


def _opposed(
    comparison: Comparison, cells: Mapping[Levels, Sequence[Row]]
) -> Iterator[tuple[Levels, Levels]]:
    """Yield the baseline's cell and the cell of a level that differs from it in the factor only."""
    by_levels = {frozenset(levels): levels for levels in cells}
    for levels in cells:
        own = dict(levels)
        if comparison.factor not in own or own[comparison.factor] == comparison.baseline:
            continue
        base = by_levels.get(frozenset((own | {comparison.factor: comparison.baseline}).items()))
        if base is not None:
            yield base, levels


def _of_shares(own: Shares, base: Shares, margin: float, metric: Metric) -> Pairs:
    _, i, j = np.intersect1d(own.seeds, base.seeds, assume_unique=True, return_indices=True)
    tried = (own.of[i] > 0) & (base.of[j] > 0)
    i, j = i[tried], j[tried]
    hits, of, base_hits, base_of = own.hits[i], own.of[i], base.hits[j], base.of[j]

    def measured(at: np.ndarray) -> tuple[float, Interval]:
        return difference_of_shares(hits[at], of[at], base_hits[at], base_of[at])

    difference, interval = measured(np.arange(len(i))) if len(i) else _NOTHING
    return Pairs(
        gains=hits / of - base_hits / base_of,
        difference=difference,
        interval=interval,
        margin=margin,
        sign=_sign(metric),
        unit="points",
        interval_of=lambda at: measured(at)[1],
    )


def _of_values(own: Samples, base: Samples, margin: float, metric: Metric) -> Pairs:
    seeds, medians = medians_by_seed(own.seeds, own.values)
    base_seeds, base_medians = medians_by_seed(base.seeds, base.values)
    _, i, j = np.intersect1d(seeds, base_seeds, assume_unique=True, return_indices=True)
    gains = medians[i] - base_medians[j]

    def interval_of(at: np.ndarray) -> Interval:
        return quantile_interval(gains[at], np.arange(len(at), dtype=np.float64), 0.5)

    return Pairs(
        gains=gains,
        difference=quantile(gains, 0.5),
        interval=interval_of(np.arange(len(gains))),
        margin=margin * abs(quantile(base_medians[j], 0.5)),
        sign=_sign(metric),
        unit=metric.unit,
        interval_of=interval_of,
    )


def _sign(metric: Metric) -> int:
    return 1 if metric.is_more_better else -1


def _difference(
    comparison: Comparison, name: str, levels: Levels, both: int, found: Pairs
) -> Difference:
    verdict, words = verdict_of(found)
    better = int((found.sign * found.gains > 0).sum())
    worse = int((found.sign * found.gains < 0).sum())
    left_out = both - len(found.gains)
    if left_out:
        words += f"; {left_out} seeds are left out, because one of the two measured nothing there"
    return Difference(
        metric=name,
        factor=comparison.factor,
        baseline=comparison.baseline,
        level=dict(levels)[comparison.factor],
        others={factor: level for factor, level in levels if factor != comparison.factor},
        pairs=len(found.gains),
        better=better,
        worse=worse,
        difference=found.difference,
        interval=found.interval,
        verdict=verdict,
        words=words,
        left_out=left_out,
        p_value=sign_test(better, worse),
    )
