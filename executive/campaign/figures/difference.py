"""Paired differences between the levels of a factor, on the same seeds."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.campaign.figures.cell import Levels, Samples, Shares, samples_of, shares_of
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.figures import Difference, Interval
from executive.campaign.figures.intervals.pairs import (
    difference_of_shares,
    mcnemar,
    medians_by_seed,
)
from executive.campaign.figures.intervals.quantile import quantile_interval
from executive.campaign.figures.row import Row
from executive.campaign.figures.verdict import verdict_of
from executive.interfaces.metric import Metric


@dataclass(frozen=True, slots=True)
class _Pairs:
    """What the pairs of a level and its baseline say."""

    pairs: int
    gains: Float  # level minus baseline by pair, shape (K,)
    difference: float
    interval: Interval
    margin: float
    p_value: float = math.nan


def differences_of(
    comparisons: Sequence[Comparison],
    metrics: Mapping[str, Metric],
    cells: Mapping[Levels, Sequence[Row]],
) -> Iterator[Difference]:
    """Yield each level's difference from the baseline, for each combination of other levels."""
    for comparison in comparisons:
        for name in comparison.metrics:
            metric = metrics[name]
            if metric.is_share:
                shares = shares_of(name, metric.is_more_better, cells)
            for base, levels in _opposed(comparison, cells):
                found = (
                    _of_shares(shares[levels], shares[base], comparison.margin)
                    if metric.is_share
                    else _of_values(
                        samples_of(name, cells[levels]),
                        samples_of(name, cells[base]),
                        comparison.margin,
                    )
                )
                both = {row.seed for row in cells[levels]} & {row.seed for row in cells[base]}
                yield _difference(comparison, name, metric, levels, len(both), found)


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


def _of_shares(own: Shares, base: Shares, margin: float) -> _Pairs:
    _, i, j = np.intersect1d(own.seeds, base.seeds, assume_unique=True, return_indices=True)
    tried = (own.of[i] > 0) & (base.of[j] > 0)
    i, j = i[tried], j[tried]
    hits, of, base_hits, base_of = own.hits[i], own.of[i], base.hits[j], base.of[j]
    if not len(i):
        return _Pairs(0, np.zeros(0), math.nan, Interval(math.nan, math.nan), margin)
    difference, interval = difference_of_shares(hits, of, base_hits, base_of)
    gains = hits / of - base_hits / base_of
    is_of_runs = bool((of == 1).all() and (base_of == 1).all())
    p_value = mcnemar(int((gains > 0).sum()), int((gains < 0).sum())) if is_of_runs else math.nan
    return _Pairs(len(i), gains, difference, interval, margin, p_value)


def _of_values(own: Samples, base: Samples, margin: float) -> _Pairs:
    seeds, medians = medians_by_seed(own.seeds, own.values)
    base_seeds, base_medians = medians_by_seed(base.seeds, base.values)
    _, i, j = np.intersect1d(seeds, base_seeds, assume_unique=True, return_indices=True)
    gains = medians[i] - base_medians[j]
    if not len(gains):
        return _Pairs(0, gains, math.nan, Interval(math.nan, math.nan), math.nan)
    interval = quantile_interval(gains, np.arange(len(gains), dtype=float), 0.5)
    matters = margin * abs(float(np.median(base_medians[j])))
    return _Pairs(len(gains), gains, float(np.median(gains)), interval, matters)


def _difference(
    comparison: Comparison,
    name: str,
    metric: Metric,
    levels: Levels,
    both: int,
    found: _Pairs,
) -> Difference:
    sign = 1 if metric.is_more_better else -1
    verdict, words = verdict_of(found.difference, found.interval, found.margin, sign, found.pairs)
    return Difference(
        metric=name,
        factor=comparison.factor,
        baseline=comparison.baseline,
        level=dict(levels)[comparison.factor],
        others={factor: level for factor, level in levels if factor != comparison.factor},
        pairs=found.pairs,
        better=int((sign * found.gains > 0).sum()),
        worse=int((sign * found.gains < 0).sum()),
        difference=found.difference,
        interval=found.interval,
        verdict=verdict,
        words=words,
        left_out=both - found.pairs,
        p_value=found.p_value,
    )
