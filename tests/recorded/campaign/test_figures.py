"""Estimates, intervals, differences and bounds over rows that are made up, with gaps in them."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive.campaign.figures.bound import STATISTICS, Bound
from executive.campaign.figures.cell import cells_of, is_broken, measured_by
from executive.campaign.figures.comparison import Comparison
from executive.campaign.figures.difference import differences_of
from executive.campaign.figures.estimate import estimates_of
from executive.campaign.figures.intervals.level import student
from executive.campaign.figures.intervals.pairs import (
    difference_of_shares,
    medians_by_seed,
    sign_test,
)
from executive.campaign.figures.intervals.quantile import quantile, quantile_interval
from executive.campaign.figures.intervals.share import clustered, effective_trials, wilson
from executive.campaign.figures.judgement import judgements_of
from executive.campaign.figures.row import Row
from executive.interfaces.metric import Metric, Share, Values

SHAPES = ("good", "weak", "none")
# Scipy's distributions may differ in the last digits between versions.
SOLVED = 1e-7


class Placed(Metric):
    title, is_share = "placed", True

    def measure(self, run):
        raise NotImplementedError


class Lost(Placed):
    is_more_better = False


class Late(Metric):
    title, unit, is_more_better = "late", "s", False

    def measure(self, run):
        raise NotImplementedError


METRICS = {"placed": Placed(), "lost": Lost(), "late": Late()}


def rows(seeds: int, better: float) -> Iterator[Row]:
    """Yield runs of three levels, of which some crashed, are faulted, or measured nothing."""
    rng = np.random.default_rng(1)
    for number, (seed, arm) in enumerate((s, a) for s in range(seeds) for a in ("a", "b", "c")):
        of = int(rng.integers(0, 7))
        hits = int(rng.binomial(of, {"a": 0.6, "b": 0.6 + better, "c": 0.5}[arm]))
        measured = {
            "placed": Share(hits, of),
            "lost": Share(of - hits, of),
            "late": Values(tuple(rng.gamma(3.0, 2.0 - better, int(rng.integers(0, 4))).tolist())),
        }
        kind = rng.integers(0, 12)
        if kind == 0:
            measured = {}
        levels = {"arm": arm, "site": "flat" if seed % 3 else "steep"}
        problems = {"late": "a.py:3"} if kind == 1 else {}
        yield Row(number, seed, levels, kind != 0, measured, kind == 2, problems)


@pytest.mark.parametrize(("seeds", "better"), [(0, 0.0), (1, 0.0), (5, 0.3), (24, 0.35)])
def test_figures(recorded, seeds, better) -> None:
    cells = cells_of(rows(seeds, better))
    measured = {name: measured_by(name, metric, cells) for name, metric in METRICS.items()}
    recorded([[is_broken(row) for row in of_cell] for of_cell in cells.values()])
    recorded({name: list(found.values()) for name, found in measured.items()})
    estimates = [one for name in METRICS for one in estimates_of(name, cells, measured[name])]
    recorded(estimates, relative=SOLVED)
    told = []
    for baseline, margin in (("a", 0.05), ("b", 0.5), ("c", 0.0), ("d", 0.1)):
        comparison = Comparison("arm", baseline, tuple(METRICS), margin)
        told += list(differences_of(comparison, METRICS, cells, measured))
    told += list(differences_of(Comparison("no", "a", ("late",)), METRICS, cells, measured))
    recorded(told, relative=SOLVED)
    bounds = [
        Bound(name, statistic, limit, is_least, where, excepted)
        for name in METRICS
        for statistic in STATISTICS
        for limit, is_least in ((0.6, True), (6.0, False), (0.6 * (1 + 1e-12), True))
        for where, excepted in (({}, {}), ({"arm": "a"}, {}), ({}, {"arm": "a", "site": "flat"}))
    ]
    judged = [
        (one.is_met, one.is_sure, one.value, one.interval)
        for one in judgements_of(bounds, estimates)
    ]
    recorded(judged, relative=SOLVED)


def test_intervals(recorded) -> None:
    rng, told = np.random.default_rng(2), []
    for share, trials in ((0.0, 1), (1.0, 1), (0.5, 4), (0.9, 33.3), (0.25, 1000)):
        told.append(wilson(share, trials))
    for size in (1, 2, 3, 10, 40):
        hits = rng.integers(0, 5, size).astype(float)
        of = hits + rng.integers(0, 3, size)
        told += [effective_trials(hits, of), clustered(hits, of), effective_trials(of, of)]
        told.append(difference_of_shares(hits, of + 1, hits[::-1], of[::-1] + 2))
        values, sites = rng.normal(size=3 * size), np.repeat(np.arange(size), 3).astype(float)
        for probability in (0.0, 0.5, 0.9, 0.95, 1.0):
            told.append(quantile(values, probability))
            told.append(quantile_interval(values, sites, probability))
            told.append(quantile_interval(values[:size], np.arange(float(size)), probability))
        told += medians_by_seed(rng.integers(0, 4, 3 * size).astype(float), values)
    told += [quantile(values[:0], 0.5), quantile_interval(values[:0], sites[:0], 0.5)]
    told += [student(degrees) for degrees in (0.5, 1, 2.5, 10, 1000)]
    told += [sign_test(better, worse) for better, worse in ((0, 0), (3, 0), (5, 1), (9, 9), (1, 8))]
    recorded(told, relative=SOLVED)
