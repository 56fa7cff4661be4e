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
    told = _Told(name, cells)
    found: dict[Levels, Shares] = {}
    for levels, rows in cells.items():
        by_seed: dict[int, list[int]] = defaultdict(lambda: [0, 0])
        assumed = 0
        for row in rows:
            measured = row.measurements.get(name)
            if not isinstance(measured, Share):
                if not (is_broken(row) and told.is_measurable):
                    continue
                of = told.trials(levels, row.seed)
                measured = Share(0 if is_more_better else of, of)
                assumed += of
            by_seed[row.seed][0] += measured.hits
            by_seed[row.seed][1] += measured.of
        table = np.array(sorted((seed, *two) for seed, two in by_seed.items()), dtype=float)
        seeds, hits, of_all = table.reshape(-1, 3).T
        found[levels] = Shares(seeds, hits, of_all, assumed)
    return found


class _Told:
    """Numbers of trials that runs tell, from which those of runs that broke off are assumed."""

    def __init__(self, name: str, cells: Mapping[Levels, Sequence[Row]]) -> None:
        self._of_seed: dict[int, dict[Levels, int]] = defaultdict(dict)
        self._usual: dict[Levels, int] = {}  # the median of each cell
        is_any_whole = False
        for levels, rows in cells.items():
            in_cell: list[int] = []
            for row in rows:
                measured = row.measurements.get(name)
                is_any_whole |= not is_broken(row)
                if isinstance(measured, Share):
                    self._of_seed[row.seed][levels] = measured.of
                    in_cell.append(measured.of)
            if in_cell:
                self._usual[levels] = median_low(in_cell)
        # Where no whole run could measure it, such as the truth on a real machine, none could.
        self.is_measurable = bool(self._of_seed) or not is_any_whole

    def trials(self, levels: Levels, seed: int) -> int:
        """Return the number of trials to assume: that of the same seed in the cell that has most
        levels in common, else the median of the runs of the cell, else that of the cells, else 1.
        """
        same_seed = self._of_seed.get(seed)
        if same_seed:
            return same_seed[max(same_seed, key=lambda other: len(set(other) & set(levels)))]
        return self._usual.get(levels, median_low(self._usual.values() or [1]))


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
