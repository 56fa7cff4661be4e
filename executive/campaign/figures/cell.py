"""The runs of one combination of levels, and what a metric says of each."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median_low

import numpy as np

from executive.arrays import Float
from executive.campaign.figures.row import Row
from executive.interfaces.metric import Metric, Share, Values

Levels = tuple[tuple[str, str], ...]  # factor and level, in the order of the factors


@dataclass(frozen=True, slots=True, eq=False)
class Shares:
    """A share over the runs of a cell, by seed.

    Attributes:
        seeds: Seeds in ascending order, shape (K,).
        hits: Hits of each seed, shape (K,).
        of: Trials of each seed, shape (K,).
        assumed: Trials among them whose number was assumed.
    """

    seeds: Float
    hits: Float
    of: Float
    assumed: int


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Values of the runs of a cell.

    Attributes:
        seeds: Seed of each value, shape (N,).
        values: The values, shape (N,).
    """

    seeds: Float
    values: Float


def cells_of(rows: Iterable[Row]) -> dict[Levels, list[Row]]:
    """Sort runs by their levels, in the order in which these first occur."""
    cells: dict[Levels, list[Row]] = defaultdict(list)
    for row in rows:
        cells[tuple(row.levels.items())].append(row)
    return dict(cells)


def measured_by(
    name: str, metric: Metric, cells: Mapping[Levels, Sequence[Row]]
) -> dict[Levels, Shares] | dict[Levels, Samples]:
    """Return what a metric says in each cell: shares or values, as its class declares."""
    if metric.is_share:
        return _shares(name, metric.is_more_better, cells)
    return {levels: _samples(name, rows) for levels, rows in cells.items()}


def is_broken(row: Row) -> bool:
    """Return whether what a run did not measure counts against it."""
    return not row.has_answer or row.is_faulted


def _shares(
    name: str, is_more_better: bool, cells: Mapping[Levels, Sequence[Row]]
) -> dict[Levels, Shares]:
    """Return a share by cell; a run that broke off counts with all its trials as the worst."""
    told = _told_trials(name, cells)
    everywhere = [of for of_seed in told.values() for of in of_seed]
    is_measurable = bool(everywhere) or all(is_broken(row) for row in _all(cells))
    found: dict[Levels, Shares] = {}
    for levels, rows in cells.items():
        own = [m.of for row in rows if isinstance(m := row.measurements.get(name), Share)]
        usual = median_low(own or everywhere or [1])
        by_seed: dict[int, list[int]] = defaultdict(lambda: [0, 0])
        assumed = 0
        for row in rows:
            measured = row.measurements.get(name)
            if not isinstance(measured, Share):
                if not (is_broken(row) and is_measurable):
                    continue
                of = told[row.seed][0] if row.seed in told else usual
                measured = Share(0 if is_more_better else of, of)
                assumed += of
            by_seed[row.seed][0] += measured.hits
            by_seed[row.seed][1] += measured.of
        table = np.array(sorted((seed, *two) for seed, two in by_seed.items()), dtype=float)
        seeds, hits, of_all = table.reshape(-1, 3).T
        found[levels] = Shares(seeds, hits, of_all, assumed)
    return found


def _samples(name: str, rows: Iterable[Row]) -> Samples:
    """Return the values of a cell."""
    seeds: list[int] = []
    values: list[float] = []
    for row in rows:
        measured = row.measurements.get(name)
        if isinstance(measured, Values):
            seeds += [row.seed] * len(measured.values)
            values += measured.values
    return Samples(np.array(seeds, dtype=float), np.array(values, dtype=float))


def _told_trials(name: str, cells: Mapping[Levels, Sequence[Row]]) -> dict[int, list[int]]:
    """Return the numbers of trials that runs tell, by seed."""
    told: dict[int, list[int]] = defaultdict(list)
    for row in _all(cells):
        measured = row.measurements.get(name)
        if isinstance(measured, Share):
            told[row.seed].append(measured.of)
    return dict(told)


def _all(cells: Mapping[Levels, Sequence[Row]]) -> Iterable[Row]:
    return (row for rows in cells.values() for row in rows)
